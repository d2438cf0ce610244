#include "octree/splat.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

namespace glowworm {
namespace {

struct DiscPoint {
    double u, v;  ///< in disc radii
};

constexpr std::uint32_t pieces_of(std::uint32_t rings) {
    return 1 + 3 * rings * (rings + 1);
}

/// Pieces of equal area: one in the middle, then rings of 6, 12, 18, ... each at the radius that
/// halves its ring's area. Built from square roots alone, so the same on every host.
std::vector<DiscPoint> disc_pattern(std::uint32_t rings) {
    constexpr double kHalfRoot3 = 0.5 * std::numbers::sqrt3;
    constexpr DiscPoint kHexagon[7] = {{1.0, 0.0},  {0.5, kHalfRoot3},   {-0.5, kHalfRoot3},
                                       {-1.0, 0.0}, {-0.5, -kHalfRoot3}, {0.5, -kHalfRoot3},
                                       {1.0, 0.0}};
    const double pieces = pieces_of(rings);
    std::vector<DiscPoint> points{{0.0, 0.0}};
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
        const double radius = std::sqrt((pieces_of(ring - 1) + 3.0 * ring) / pieces);
        for (std::uint32_t side = 0; side < 6; ++side) {
            for (std::uint32_t step = 0; step < ring; ++step) {
                const double t = static_cast<double>(step) / ring;
                const DiscPoint a = kHexagon[side], b = kHexagon[side + 1];
                const double u = a.u + (b.u - a.u) * t, v = a.v + (b.v - a.v) * t;
                const double scale = radius / std::sqrt(u * u + v * v);
                points.push_back({u * scale, v * scale});
            }
        }
    }
    return points;
}

const std::vector<DiscPoint>& pattern_of(std::uint32_t rings) {
    static const auto patterns = [] {
        std::array<std::vector<DiscPoint>, kMaxSplatRings + 1> all;
        for (std::uint32_t i = 0; i <= kMaxSplatRings; ++i)
            all[i] = disc_pattern(i);
        return all;
    }();
    return patterns[rings];
}

/// A surfel's position and two directions along its disc.
class DiscFrame {
  public:
    explicit DiscFrame(const Surfel& surfel) : position_(vec3_cast<double>(surfel.position)) {
        // Without branches (Duff et al. 2017, Building an Orthonormal Basis, Revisited).
        const Vec3d n = vec3_cast<double>(surfel.normal);
        const double sign = n.z < 0.0 ? -1.0 : 1.0;
        const double a = -1.0 / (sign + n.z);
        const double b = n.x * n.y * a;
        tangent_ = {1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
        bitangent_ = {b, sign + n.y * n.y * a, -n.y};
    }

    Vec3d at(const DiscPoint& point, double radius) const {
        return position_ + tangent_ * (point.u * radius) + bitangent_ * (point.v * radius);
    }

  private:
    Vec3d position_, tangent_, bitangent_;
};

}  // namespace

Splat splat_of(const Surfel& surfel, double voxel) {
    constexpr double kWiden = 2.0;  // at one sample a voxel face: 1.5 loses four times the light
    const double radius = surfel.radius;
    Splat splat;
    splat.area = std::numbers::pi * radius * radius;
    const double side = radius / std::numbers::inv_sqrtpi;  // sqrt(area)
    splat.radius = radius * std::clamp(kWiden * side / voxel, 1.0, 2.0);
    // Pieces are sqrt(pi R² / n) apart; a quarter of a voxel at most, or leaves that no sample of a
    // random cloud falls into would be holes: 1 in 70 at 4 samples a face.
    const double needed = 16.0 * std::numbers::pi * splat.radius * splat.radius / (voxel * voxel);
    while (splat.pieces < needed && splat.rings < kMaxSplatRings) {
        splat.pieces = pieces_of(++splat.rings);
    }
    return splat;
}

Vec3d piece_position(const Surfel& surfel, const Splat& splat, std::uint32_t piece) {
    return DiscFrame(surfel).at(pattern_of(splat.rings)[piece], splat.radius);
}

bool stays_inside(const Surfel& surfel, const Splat& splat, const Grid& grid) {
    const Vec3d at = (vec3_cast<double>(surfel.position) - vec3_cast<double>(grid.cube_min)) *
                     (1.0 / grid.voxel_size());
    const double reach = splat.radius / grid.voxel_size() + 1e-6;
    bool inside = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double n = surfel.normal[axis];
        const double extent = reach * std::sqrt(std::max(0.0, 1.0 + 1e-6 - n * n));
        const double fraction = at[axis] - std::floor(at[axis]);
        inside = inside && fraction >= extent && fraction <= 1.0 - extent;
    }
    return inside;
}

DiscPieces::DiscPieces(const Grid& grid)
    : grid_(grid),
      voxel_(grid.voxel_size()),
      shift_(kMortonLevels - grid.depth),
      lower_(vec3_cast<double>(grid.cube_min)),
      upper_(lower_ + Vec3d{1.0, 1.0, 1.0} * static_cast<double>(grid.cube_edge)) {}

void DiscPieces::place(const Surfel& surfel) {
    splat_ = splat_of(surfel, voxel_);
    const DiscFrame frame(surfel);
    const std::vector<DiscPoint>& pattern = pattern_of(splat_.rings);
    for (std::uint32_t i = 0; i < splat_.pieces; ++i) {
        // What sticks out of the root cube is moved to its side: area is conserved.
        positions_[i] =
            component_max(lower_, component_min(upper_, frame.at(pattern[i], splat_.radius)));
        const Vec3d at = grid_.finest_coordinates(positions_[i]);
        cells_[i] = {static_cast<std::uint32_t>(at.x) >> shift_,
                     static_cast<std::uint32_t>(at.y) >> shift_,
                     static_cast<std::uint32_t>(at.z) >> shift_};
    }
}

void DiscPieces::add_to(LeafSums& leaf, const Surfel& surfel, std::uint32_t first) {
    std::size_t count = 0;
    for (std::uint32_t i = first; i < splat_.pieces; ++i) {
        if (cells_[i] == cells_[first]) inside_[count++] = positions_[i];
    }
    const double share = static_cast<double>(count) / splat_.pieces;
    leaf.add_all({{},
                  vec3_cast<double>(surfel.normal) * static_cast<double>(surfel.ndf_length),
                  vec3_cast<double>(surfel.albedo),
                  vec3_cast<double>(surfel.emission),
                  splat_.area * share,
                  share,
                  0.0,
                  surfel.light},
                 std::span(inside_).first(count));
}

}  // namespace glowworm
