#include "viewer/light/smoothing.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>

#include "viewer/gpu/glsl.h"
#include "viewer/gpu/vec4.h"
#include "viewer/light/smoothing_weights.h"

namespace glowworm {
namespace gpu {
namespace {

struct WallPass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const LobeLight> lobe_lights;
    LightGrid grid;

#include "shaders/light_lookup.glsl"
};

}  // namespace
}  // namespace gpu

namespace {

constexpr std::uint32_t kBlockLevels =
    2;                              // lobes of 2 x 2 x 2 leaves find their neighbours at once
constexpr std::int32_t kReach = 4;  // leaves: twice the tricubic kernel's two

using Channels [[gnu::vector_size(16)]] = float;

/// A lobe's light by channels instead of by axes: sums run over all channels at once. The fourth of
/// `irradiance` is its wall (LobeLight).
struct LightOfLobe {
    Channels irradiance, turn[3], around;

    float wall() const { return irradiance[3]; }
};

struct Cell {
    std::uint32_t node, level;
    Vec3<std::int32_t> at;  // in cells of its level
};

class Smoothing {
  public:
    explicit Smoothing(const LookupInput& input) : input_(input), lights_(input.lobes.size()) {
        tbb::parallel_for(std::size_t{0}, lights_.size(), [&](std::size_t i) {
            const gpu::LobeLight& light = input.lobe_lights[i];
            const auto channels = [&](int axis) {
                return Channels{light.turn[0][axis], light.turn[1][axis], light.turn[2][axis]};
            };
            const gpu::vec4& irradiance = light.irradiance;
            lights_[i].irradiance =
                Channels{irradiance.x, irradiance.y, irradiance.z, irradiance.w};
            for (int axis = 0; axis < 3; ++axis)
                lights_[i].turn[axis] = channels(axis);
            lights_[i].around = channels(3);
        });
    }

    std::vector<gpu::LobeLight> all() const {
        std::vector<gpu::LobeLight> smooth(input_.lobe_lights.begin(), input_.lobe_lights.end());
        const std::vector<Cell> blocks = cells_at(depth() - std::min(depth(), kBlockLevels));
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks.size(), 16),
                          [&](const auto& range) {
                              LobesTogether near;
                              std::vector<float> weights;
                              for (std::size_t b = range.begin(); b != range.end(); ++b)
                                  smooth_block(blocks[b], near, weights, smooth);
                          });
        return smooth;
    }

  private:
    std::uint32_t depth() const { return input_.grid.depth; }

    /// Visits the children of a node.
    template <typename Visit>
    void for_each_child(const Cell& cell, const Visit& visit) const {
        const Node& node = input_.nodes[cell.node];
        std::uint32_t child = node.first;
        for (std::int32_t octant = 0; octant < 8; ++octant) {
            if ((node.mask >> octant & 1u) == 0) continue;
            visit(Cell{child++,
                       cell.level + 1,
                       {2 * cell.at.x + (octant & 1), 2 * cell.at.y + (octant >> 1 & 1),
                        2 * cell.at.z + (octant >> 2)}});
        }
    }

    std::vector<Cell> cells_at(std::uint32_t level) const {
        std::vector<Cell> cells, next;
        if (!input_.nodes.empty()) cells.push_back({0, 0, {0, 0, 0}});
        for (std::uint32_t above = 0; above < level; ++above) {
            next.clear();
            for (const Cell& cell : cells)
                for_each_child(cell, [&](const Cell& child) { next.push_back(child); });
            cells.swap(next);
        }
        return cells;
    }

    /// The lobes of the leaves from `low` to `high`, and of those beside them in a node.
    void find(const Cell& cell, const Vec3<std::int32_t>& low, const Vec3<std::int32_t>& high,
              LobesTogether& near) const {
        if (cell.level == depth()) {
            const Node& leaf = input_.nodes[cell.node];
            const float per_edge = 1.0f / input_.grid.voxel_size;
            const Vec3f cube_min{input_.grid.cube_min_x, input_.grid.cube_min_y,
                                 input_.grid.cube_min_z};
            const Vec3f middle = vec3_cast<float>(cell.at) + Vec3f{0.5f, 0.5f, 0.5f};
            for (std::uint32_t i = leaf.first; i < leaf.first + (leaf.mask >> 8 & 7u); ++i) {
                const Lobe& lobe = input_.lobes[i];
                near.add(i, middle, (to_vec3(lobe.position) - cube_min) * per_edge,
                         normalized(to_vec3(lobe.ndf)));
            }
            return;
        }
        const std::uint32_t shift = depth() - cell.level - 1;
        for_each_child(cell, [&](const Cell& child) {
            for (int a = 0; a < 3; ++a) {
                if (child.at[a] << shift > high[a] || (child.at[a] + 1) << shift <= low[a]) return;
            }
            find(child, low, high, near);
        });
    }

    void smooth_block(const Cell& block, LobesTogether& near, std::vector<float>& weights,
                      std::vector<gpu::LobeLight>& smooth) const {
        const std::uint32_t shift = depth() - block.level;
        Vec3<std::int32_t> low, high;
        for (int a = 0; a < 3; ++a) {
            low[a] = (block.at[a] << shift) - kReach;
            high[a] = ((block.at[a] + 1) << shift) - 1 + kReach;
        }
        near.clear();
        find({0, 0, {0, 0, 0}}, low, high, near);
        for (std::size_t i = 0; i < near.size(); ++i) {
            bool inside = true;
            for (int a = 0; a < 3; ++a) {
                const auto cell = static_cast<std::int32_t>(near.cell[a][i]);
                inside = inside && cell >> shift == block.at[a];
            }
            if (!inside) continue;
            smoothing_weights(near, i, weights);
            smooth[near.lobe[i]] = mean(near, i, weights);
        }
    }

    /// The lobe's light, of all near ones turned to its normal.
    gpu::LobeLight mean(const LobesTogether& near, std::size_t i,
                        std::span<const float> weights) const {
        const std::uint32_t lobe = near.lobe[i];
        const gpu::LobeLight& own = input_.lobe_lights[lobe];
        Channels irradiance{}, turn[3]{};
        float all = 0.0f;
        for (std::size_t k = 0; k < near.size(); ++k) {
            if (!(weights[k] > 0.0f)) continue;
            const std::uint32_t other = near.lobe[k];
            const LightOfLobe& light = lights_[other];
            const bool open = lights_[lobe].wall() == 0.0f && light.wall() == 0.0f;
            const float weight = weights[k] * (open ? 1.0f : through_walls(lobe, other));
            float cosine = 0.0f;
            for (int a = 0; a < 3; ++a)
                cosine += near.normal[a][i] * near.normal[a][k];
            Channels turned = light.irradiance * (0.5f * (1.0f + cosine)) +
                              light.around * (0.5f * (1.0f - cosine));
            for (int a = 0; a < 3; ++a) {
                turned += light.turn[a] * (near.normal[a][i] - cosine * near.normal[a][k]);
                turn[a] += light.turn[a] * weight;
            }
            irradiance += (turned > 0.0f ? turned : Channels{}) * weight;
            all += weight;
        }
        if (!(all > 0.0f)) return own;
        gpu::LobeLight smooth = own;
        for (int c = 0; c < 3; ++c) {
            smooth.irradiance[c] = irradiance[c] / all;
            for (int a = 0; a < 3; ++a)
                smooth.turn[c][a] = turn[a][c] / all;
        }
        return smooth;
    }

    /// Of the weight that `other` has for `lobe`, what walls beside them leave.
    float through_walls(std::uint32_t lobe, std::uint32_t other) const {
        gpu::WallPass pass{input_.nodes, input_.lobes, input_.lobe_lights, input_.grid};
        const gpu::vec3 here = pass.lobe_position(lobe), there = pass.lobe_position(other);
        return pass.wall_between(pass.wall_beside(lobe), here, there) ||
                       pass.wall_between(pass.wall_beside(other), there, here)
                   ? pass.kThroughWall
                   : 1.0f;
    }

    const LookupInput& input_;
    std::vector<LightOfLobe> lights_;
};

}  // namespace

std::vector<gpu::LobeLight> smoothed(const LookupInput& input) {
    return Smoothing(input).all();
}

}  // namespace glowworm
