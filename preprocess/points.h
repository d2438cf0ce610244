#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "octree/surfel.h"
#include "octree/vec3.h"

namespace glowworm {

/// sRGB-encoded colour.
struct Rgb8 {
    std::uint8_t r = 0, g = 0, b = 0;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// Where a point lies in the grid that a scanner sweeps, as its file counts.
struct GridCell {
    std::uint32_t row = 0, column = 0;
    friend bool operator==(const GridCell&, const GridCell&) = default;
};

/// Points as columns. A column is either empty (the points do not have it) or as long as
/// `positions`.
struct Points {
    std::vector<Vec3f> positions;         ///< m
    std::vector<Vec3f> normals;           ///< unit
    std::vector<Rgb8> colours;            ///< sRGB
    std::vector<float> intensities;       ///< the scanner's own scale
    std::vector<float> ndf_lengths;       ///< Toksvig length in (0, 1]
    std::vector<float> radii;             ///< m
    std::vector<std::uint32_t> stations;  ///< index into PointCloud::stations
    std::vector<Vec3f> emissions;         ///< radiance, W·sr⁻¹·m⁻²
    std::vector<double> times;            ///< s, the scanner's own clock
    std::vector<GridCell> grid;           ///< of organised scans

    std::size_t size() const { return positions.size(); }
    bool empty() const { return positions.empty(); }

    /// Keeps the points at `indices`, in that order, in every column that is there.
    Points select(const std::vector<std::uint32_t>& indices) const;

    /// Appends `other`. A column that only one of the two has is dropped, so that none is half
    /// full.
    void append(const Points& other);
};

/// All stations in one world frame, each point knowing the one it was seen from.
struct PointCloud {
    Vec3d origin;  ///< m, world; positions are relative to it
    Points points;
    std::vector<Station> stations;
    std::vector<AreaLight> area_lights;
};

}  // namespace glowworm
