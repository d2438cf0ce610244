#include "viewer/light/cones.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <numbers>

#include "octree/error.h"
#include "octree/morton.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::size_t kLobesAtOnce = 1 << 14;  // a dispatch stays short enough for a display's GPU
constexpr std::size_t kSideBytes = 8;
constexpr double kFootprint =
    0.35;  // of the geometric aperture: wider lets far walls swallow light

/// How many cones each ring round the normal has, the innermost first.
std::vector<int> rings_of(int count) {
    switch (count) {
        case 4:
            return {1, 3};
        case 5:
            return {1, 4};
        case 6:
            return {1, 5};
        case 9:
            return {2, 7};
        case 10:
            return {3, 7};
        case 16:
            return {1, 5, 10};
        default:
            throw Error(ExitCode::kUsage,
                        fmt::format("{} cones are not a set: take 4, 5, 6, 9, 10 or 16", count));
    }
}

gpu::vec4 cone_of(double sine_squared, double azimuth, double spread, double weight) {
    return {static_cast<float>(sine_squared), static_cast<float>(azimuth),
            static_cast<float>(spread), static_cast<float>(weight)};
}

/// Node of every cell of levels 0 to DENSE_LEVELS, kNoHit where empty.
std::vector<std::uint32_t> dense_nodes(const OctreeView& octree) {
    const std::uint32_t last = std::min<std::uint32_t>(octree.grid.depth, DENSE_LEVELS);
    const auto first_of = [](std::uint32_t level) { return ((1u << (3 * level)) - 1u) / 7u; };
    std::vector<std::uint32_t> dense(first_of(last + 1), kNoHit);
    std::vector<CellIndex> cells{{0, 0, 0}}, below;
    for (std::uint32_t level = 0; level <= last; ++level) {
        below.clear();
        for (std::uint32_t i = 0; i < octree.levels[level].node_count; ++i) {
            const std::uint32_t node = octree.levels[level].first_node + i;
            const CellIndex& cell = cells[i];
            dense[first_of(level) + (cell.x | cell.y << level | cell.z << (2 * level))] = node;
            for (std::uint32_t octant = 0; octant < 8; ++octant) {
                if ((octree.nodes[node].mask >> octant & 1u) == 0) continue;
                below.push_back({2 * cell.x + (octant & 1u), 2 * cell.y + (octant >> 1 & 1u),
                                 2 * cell.z + (octant >> 2)});
            }
        }
        cells.swap(below);
    }
    return dense;
}

}  // namespace

std::vector<gpu::vec4> cone_set(int count, bool faithful) {
    std::vector<gpu::vec4> cones;
    if (faithful) {
        const double spread = 2.0 * std::tan(std::numbers::pi / 6.0);
        cones.push_back(cone_of(0.0, 0.0, spread, 0.25));
        for (int i = 0; i < 5; ++i)
            cones.push_back(cone_of(0.75, i / 5.0, spread, 0.15));
        return cones;
    }
    double inner = 0.0;  // sin² where the ring begins: the share of irradiance inside it
    for (const int in_ring : rings_of(count)) {
        const double outer = inner + static_cast<double>(in_ring) / count;
        // Half angle of a round cone with the sector's solid angle 2 pi (cos - cos) / n.
        const double share =
            (std::sqrt(1.0 - inner) - std::sqrt(std::max(0.0, 1.0 - outer))) / in_ring;
        const double half_angle = std::acos(1.0 - share);
        const double middle = in_ring == 1 && inner == 0.0 ? 0.0 : 0.5 * (inner + outer);
        for (int i = 0; i < in_ring; ++i) {
            cones.push_back(cone_of(middle, static_cast<double>(i) / in_ring,
                                    kFootprint * 2.0 * std::tan(half_angle), 1.0 / count));
        }
        inner = outer;
    }
    return cones;
}

ConeGather::ConeGather(const OctreeView& octree, const LightSettings& settings)
    : levels_(octree.levels.begin(), octree.levels.end()),
      lobes_(octree.lobes.size()),
      cones_(cone_set(settings.cones, settings.faithful)),
      sides_("node sides", octree.nodes.size() * 6 * kSideBytes),
      filter_leaves_({"filter_leaves.comp"}),
      filter_nodes_({"filter_nodes.comp"}),
      gather_({"gather_cones.comp"}) {
    const auto dense = dense_nodes(octree);
    dense_ = Buffer::of("coarse cells", std::span<const std::uint32_t>(dense));
}

void ConeGather::filter() const {
    sides_.bind_storage(BINDING_SIDES);
    dense_.bind_storage(BINDING_DENSE);
    for (std::size_t level = levels_.size(); level-- > 0;) {
        const Program& pass = level + 1 == levels_.size() ? filter_leaves_ : filter_nodes_;
        set_uniform(pass, 0, levels_[level].first_node);
        set_uniform(pass, 1, levels_[level].node_count);
        pass.dispatch(levels_[level].node_count, kGroup);
    }
}

void ConeGather::gather() const {
    sides_.bind_storage(BINDING_SIDES);
    dense_.bind_storage(BINDING_DENSE);
    set_uniform(gather_, 2, static_cast<std::uint32_t>(cones_.size()));
    glProgramUniform4fv(gather_.name(), 3, static_cast<GLsizei>(cones_.size()), &cones_[0].x);
    for (std::size_t first = 0; first < lobes_; first += kLobesAtOnce) {
        const std::size_t last = std::min(lobes_, first + kLobesAtOnce);
        set_uniform(gather_, 0, static_cast<std::uint32_t>(first));
        set_uniform(gather_, 1, static_cast<std::uint32_t>(last));
        gather_.dispatch(last - first, kGroup);
    }
}

}  // namespace glowworm
