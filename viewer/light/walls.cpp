#include "viewer/light/walls.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>

#include "viewer/gpu/glsl.h"

namespace glowworm {
namespace gpu {
namespace {

#include "shaders/wall.glsl"

}  // namespace
}  // namespace gpu

namespace {

constexpr float kReach = 3.0f;   // leaf edges from a lobe to the plane of its wall
constexpr float kBeside = 1.0f;  // leaf edges from its foot there to the middle of the wall's lobe
constexpr float kInFront = -0.2f;  // leaf edges over its plane: at a wall's foot means lie under it
constexpr float kRises = 0.5f;     // cosine of 60 degrees, as where lobes are told apart
constexpr float kMixed = 4.0f;     // leaf edges: lobes that smoothing mixes
constexpr float kLevel = 1.5f;     // leaf edges off the lobe's plane: so do those

/// A lobe as a piece of plane.
struct Plane {
    Vec3f position, normal;
};

class WallSearch {
  public:
    explicit WallSearch(const OctreeView& octree) : octree_(octree) {
        planes_.reserve(octree.lobes.size());
        for (const Lobe& lobe : octree.lobes) {
            planes_.push_back({to_vec3(lobe.position), normalized(to_vec3(lobe.ndf))});
        }
    }

    std::uint32_t beside(std::uint32_t lobe) const {
        const Plane& here = planes_[lobe];
        const float edge = octree_.grid.voxel_size();
        std::vector<Wall> walls;
        for_each_lobe_near(here.position, kReach, [&](std::uint32_t other) {
            const Plane& there = planes_[other];
            const Vec3f apart = here.position - there.position;
            const float height = dot(there.normal, apart);
            const Vec3f aside = apart - there.normal * height;
            if (dot(there.normal, here.normal) < kRises && height > kInFront * edge &&
                height < kReach * edge && dot(aside, aside) < kBeside * kBeside * edge * edge &&
                octree_.lobes[other].light == 0) {
                walls.push_back({height, other});
            }
        });
        if (walls.empty()) return 0;
        std::vector<std::uint32_t> level;
        for_each_lobe_near(here.position, kMixed, [&](std::uint32_t other) {
            const Plane& there = planes_[other];
            if (dot(there.normal, here.normal) > kRises &&
                std::abs(dot(here.normal, there.position - here.position)) < kLevel * edge) {
                level.push_back(other);
            }
        });
        std::ranges::sort(walls);
        for (const Wall& wall : walls) {
            for (const std::uint32_t other : level) {
                if (is_between(planes_[wall.lobe], here.position, planes_[other].position))
                    return wall.lobe + 1;
            }
        }
        return 0;
    }

  private:
    struct Wall {
        float height;  // m, of the lobe over its plane
        std::uint32_t lobe;
        auto operator<=>(const Wall&) const = default;
    };

    bool is_between(const Plane& wall, const Vec3f& here, const Vec3f& there) const {
        using gpu::vec3_of;
        return gpu::stands_between(vec3_of(wall.normal), vec3_of(wall.position),
                                   octree_.grid.voxel_size(), vec3_of(here), vec3_of(there));
    }

    struct Ahead {
        std::uint32_t node, level;
        Vec3<int> cell;
    };

    /// Visits the lobes of the leaves within `reach` leaf edges along every axis.
    template <typename Visit>
    void for_each_lobe_near(const Vec3f& position, float reach, const Visit& visit) const {
        const Vec3f place = (position - octree_.grid.cube_min) / octree_.grid.voxel_size();
        const auto cells = static_cast<float>(1u << octree_.grid.depth);
        Vec3<int> low, high;
        for (int a = 0; a < 3; ++a) {
            if (!(place[a] >= 0.0f && place[a] <= cells)) return;
            low[a] = static_cast<int>(place[a] - reach);
            high[a] = static_cast<int>(place[a] + reach);
        }
        std::array<Ahead, 7 * kMaxDepth + 8> ahead;  // seven siblings wait on each level
        std::size_t waiting = 0;
        ahead[waiting++] = {0, 0, {0, 0, 0}};
        while (waiting > 0) {
            const Ahead here = ahead[--waiting];
            const Node& node = octree_.nodes[here.node];
            if (here.level == octree_.grid.depth) {
                const std::uint32_t last = node.first + (node.mask >> 8 & 7u);
                for (std::uint32_t i = node.first; i < last; ++i)
                    visit(i);
                continue;
            }
            const std::uint32_t shift = octree_.grid.depth - here.level - 1;
            std::uint32_t child = node.first;
            for (std::uint32_t octant = 0; octant < 8; ++octant) {
                if ((node.mask >> octant & 1u) == 0) continue;
                const Vec3<int> cell{2 * here.cell.x + static_cast<int>(octant & 1u),
                                     2 * here.cell.y + static_cast<int>(octant >> 1 & 1u),
                                     2 * here.cell.z + static_cast<int>(octant >> 2)};
                bool near = true;
                for (int a = 0; a < 3; ++a)
                    near &= cell[a] << shift <= high[a] && ((cell[a] + 1) << shift) > low[a];
                if (near) ahead[waiting++] = {child, here.level + 1, cell};
                ++child;
            }
        }
    }

    const OctreeView& octree_;
    std::vector<Plane> planes_;
};

}  // namespace

std::vector<std::uint32_t> walls_beside(const OctreeView& octree) {
    std::vector<std::uint32_t> walls(octree.lobes.size());
    const LobeRange all{0, static_cast<std::uint32_t>(walls.size())};
    find_walls_beside(octree, std::span(&all, 1), walls);
    return walls;
}

void find_walls_beside(const OctreeView& octree, std::span<const LobeRange> ranges,
                       std::span<std::uint32_t> walls) {
    if (walls.empty()) return;
    const WallSearch search(octree);
    tbb::parallel_for(std::size_t{0}, ranges.size(), [&](std::size_t r) {
        tbb::parallel_for(tbb::blocked_range<std::uint32_t>(ranges[r].first, ranges[r].last, 256),
                          [&](const auto& range) {
                              for (std::uint32_t lobe = range.begin(); lobe != range.end(); ++lobe)
                                  walls[lobe] = search.beside(lobe);
                          });
    });
}

}  // namespace glowworm
