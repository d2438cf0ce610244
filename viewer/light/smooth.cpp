#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <bit>
#include <cmath>

#include "viewer/gpu/vec4.h"
#include "viewer/light/bounce.h"

namespace glowworm {

namespace {

constexpr float kSmoothing = 2.0f;  // smooth_light.comp: widths of the lookup's kernel

/// A node on the way down, and where it lies in cells of its level.
struct NodeAhead {
    std::uint32_t node, level;
    Vec3<int> cell;
};

/// Cubic B-spline at `d` knots from its middle.
float spline(float d) {
    d = std::abs(d);
    if (d >= 2.0f) return 0.0f;
    const float r = 2.0f - d;
    return d >= 1.0f ? r * r * r / 6.0f : (4.0f - 6.0f * d * d + 3.0f * d * d * d) / 6.0f;
}

/// light_lookup.glsl says why: lobes that face the same way and lie in the same plane count.
float surface_weight(float cosine, float height) {
    const float c2 = cosine * cosine;
    return c2 * c2 * c2 * c2 * std::exp(-4.0f * std::min(height * height, 16.0f));
}

/// Irradiance of `light`, of a surface along `lobe_normal`, if it faced along `normal`.
Vec3f turned_irradiance(const gpu::LobeLight& light, const Vec3f& lobe_normal,
                        const Vec3f& normal) {
    const float cosine = dot(normal, lobe_normal);
    const Vec3f tilt = normal - cosine * lobe_normal;
    Vec3f sum = 0.5f * (1.0f + cosine) * to_vec3(light.irradiance);
    for (int c = 0; c < 3; ++c) {
        const float turn = dot(tilt, to_vec3(light.turn[c]));
        sum[c] = std::max(sum[c] + turn + 0.5f * (1.0f - cosine) * light.turn[c].w, 0.0f);
    }
    return sum;
}

class Smoothing {
  public:
    Smoothing(const OctreeView& octree, std::span<const gpu::LobeLight> lights)
        : octree_(octree), lights_(lights) {
        for (const Lobe& lobe : octree.lobes)
            normals_.push_back(normalized(Vec3f{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]}));
    }

    gpu::LobeLight at(std::size_t lobe) const {
        const Grid& grid = octree_.grid;
        const Vec3f position = position_of(lobe);
        const Vec3f place =
            (position - grid.cube_min) / grid.voxel_size() - Vec3f{0.5f, 0.5f, 0.5f};
        const auto cells = static_cast<float>(1u << grid.depth);
        Vec3<int> low, high;
        for (int a = 0; a < 3; ++a) {
            if (!(place[a] >= -1.0f && place[a] <= cells)) return lights_[lobe];
            low[a] = static_cast<int>(std::ceil(place[a] - 2.0f * kSmoothing));
            high[a] = static_cast<int>(std::floor(place[a] + 2.0f * kSmoothing));
        }
        Sums sums;
        std::array<NodeAhead, 7 * kMaxDepth + 8> ahead;  // seven siblings wait on each level
        std::size_t waiting = 0;
        ahead[waiting++] = {0, 0, {0, 0, 0}};
        while (waiting > 0) {
            const NodeAhead here = ahead[--waiting];
            const Node& node = octree_.nodes[here.node];
            if (here.level == grid.depth) {
                const Vec3f d = (vec3_cast<float>(here.cell) - place) / kSmoothing;
                add_leaf(node, spline(d.x) * spline(d.y) * spline(d.z), position, normals_[lobe],
                         sums);
                continue;
            }
            const std::uint32_t shift = grid.depth - here.level - 1;
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
        return sums.mean(lights_[lobe]);
    }

  private:
    struct Sums {
        float weight = 0.0f;
        Vec3f irradiance, turn[3];

        gpu::LobeLight mean(const gpu::LobeLight& own) const {
            if (!(weight > 0.0f)) return own;
            gpu::LobeLight light = own;
            const Vec3f e = irradiance / weight;
            light.irradiance = {e.x, e.y, e.z, 1.0f};
            for (int c = 0; c < 3; ++c) {
                const Vec3f t = turn[c] / weight;
                light.turn[c] = {t.x, t.y, t.z, own.turn[c].w};
            }
            return light;
        }
    };

    Vec3f position_of(std::size_t lobe) const {
        const float(&p)[3] = octree_.lobes[lobe].position;
        return {p[0], p[1], p[2]};
    }

    void add_leaf(const Node& leaf, float leaf_weight, const Vec3f& position, const Vec3f& normal,
                  Sums& sums) const {
        const std::uint32_t last = leaf.first + (leaf.mask >> 8 & 3u);
        for (std::uint32_t i = leaf.first; i < last; ++i) {
            const float cosine = dot(normal, normals_[i]);
            if (cosine <= 0.0f) continue;
            const float height = dot(normal, position_of(i) - position) / octree_.grid.voxel_size();
            const float weight = leaf_weight * surface_weight(cosine, height);
            if (!(weight > 0.0f)) continue;
            sums.weight += weight;
            sums.irradiance += turned_irradiance(lights_[i], normals_[i], normal) * weight;
            for (int c = 0; c < 3; ++c)
                sums.turn[c] += to_vec3(lights_[i].turn[c]) * weight;
        }
    }

    const OctreeView& octree_;
    std::span<const gpu::LobeLight> lights_;
    std::vector<Vec3f> normals_;
};

}  // namespace

std::vector<gpu::LobeLight> smoothed(const OctreeView& octree,
                                     std::span<const gpu::LobeLight> lights) {
    const Smoothing smoothing(octree, lights);
    std::vector<gpu::LobeLight> result(lights.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lights.size(), 128),
                      [&](const auto& range) {
                          for (std::size_t lobe = range.begin(); lobe != range.end(); ++lobe)
                              result[lobe] = smoothing.at(lobe);
                      });
    return result;
}

}  // namespace glowworm
