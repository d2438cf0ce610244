#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/read/e57_pages.h"

namespace glowworm {

/// A value of every point, in the order in which its bytes come in the packets.
struct E57Field {
    enum class Type : std::uint8_t { kFloat, kDouble, kInteger, kScaledInteger, kString };

    std::string name;  ///< "cartesianX", "nor:normalX"
    Type type = Type::kDouble;
    std::int64_t minimum = 0;  ///< of integers: what the stored bits count from
    std::int64_t maximum = 0;
    double scale = 1.0, offset = 0.0;  ///< of scaled integers: value = scale * stored + offset
    std::uint32_t bits = 64;  ///< of one value; 0 where minimum = maximum; strings: unknown
};

/// What a value must be scaled by: least is 0, most is 1.
struct E57Range {
    double least = 0.0, most = 0.0;
};

/// A scan (an element of data3D) before its points.
struct E57Scan {
    std::string name, description, sensor;
    std::optional<Eigen::Isometry3d> T_world_scan;
    std::vector<E57Field> fields;
    std::uint64_t record_count = 0;
    std::uint64_t section = 0;  ///< logical offset of its points
    std::optional<E57Range> intensity_limits;
    std::optional<E57Range> colour_limits[3];
    std::vector<std::string> notes;  ///< full sentences

    /// Index of the field of this name, else of one with an extension's prefix before it; -1 where
    /// there is neither.
    int field(std::string_view field_name) const;
};

struct E57File {
    std::string version;  ///< "1.0"
    std::string library;  ///< what wrote it, empty where not said
    std::string crs;      ///< coordinateMetadata: WKT, mostly empty
    std::vector<E57Scan> scans;
};

/// Reads the header and the XML section of an E57 file (ASTM E2807-11). Throws Error (kUnreadable)
/// for what is damaged or cut short.
E57File read_e57_header(E57Pages& pages);

}  // namespace glowworm
