#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// Lobes near each other, each of their numbers in an array of its own, so that the compiler takes
/// several of them at once.
struct LobesTogether {
    std::vector<float> cell[3];      ///< leaf edges: the middle of each lobe's leaf
    std::vector<float> position[3];  ///< leaf edges
    std::vector<float> normal[3];
    std::vector<std::uint32_t> lobe;

    std::size_t size() const { return lobe.size(); }
    void clear();
    void add(std::uint32_t number, const Vec3f& middle, const Vec3f& at, const Vec3f& unit_normal);
};

/// weights[k]: how much lobe k counts at the place and normal of lobe i, by light_lookup.glsl with
/// the tricubic kernel twice as wide. As many as there are lobes.
void smoothing_weights(const LobesTogether& lobes, std::size_t i, std::vector<float>& weights);

}  // namespace glowworm
