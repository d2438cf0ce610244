#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

/// One scan of an E57 file that is to be written: what its place in the file and its description
/// follow from, before any of its points is.
struct E57ScanLayout {
    Station station;
    std::vector<std::uint32_t> indices;  ///< of its points in the cloud
    Vec3d least, most;                   ///< m, of its points in the station's frame
    float least_intensity = 0.0f, most_intensity = 0.0f;
    bool doubles = false;  ///< coordinates as double
    bool colours = false, intensities = false, normals = false, times = false, grid = false;
    GridCell first_cell, last_cell;  ///< least and greatest row and column

    std::size_t field_count() const;
    std::size_t record_bytes() const;
    std::size_t packet_records() const;  ///< points in a full packet
    std::size_t packet_count() const;    ///< at least one
    std::size_t packet_bytes(std::size_t packet) const;

    /// Of all packets, without the section's header of 32 bytes.
    std::uint64_t content_bytes() const;

    std::uint64_t section = 0;  ///< logical offset, set by lay_out_e57
};

inline constexpr std::uint64_t kE57HeaderBytes = 48, kE57SectionHeadBytes = 32;

/// The scans of a cloud, a station each, and where they lie in the file.
std::vector<E57ScanLayout> lay_out_e57(const PointCloud& cloud, const std::string& name);

/// A point of the cloud in its station's frame, m.
Vec3d to_station(const Station& station, const Vec3d& world);
Vec3d rotate_to_station(const Station& station, const Vec3d& direction);

/// The XML section that describes `scans`. Names that are not UTF-8 or hold control characters are
/// written with '?' in their place.
std::string e57_description(std::span<const E57ScanLayout> scans, std::uint64_t content_hash);

}  // namespace glowworm
