#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shaders/gpu_layout.h"

namespace glowworm {

/// <d_i, d_j> as 00 01 02 11 12 22, <d_j, r>, |r|², |x|² and the sum of relative changes: r is what
/// a bounce changes, d_j how much less it changed j bounces ago. Of luminance.
using AndersonSums = std::array<double, 12>;

/// Where iterates are kept, the newest first.
using AndersonSlots = std::array<std::uint32_t, 4>;

/// Twins of anderson_sums.comp and anderson_mix.comp, for where OpenGL runs on the CPU. On all
/// cores, the same on any number of them. Spans are as long as `count`.
class AndersonPasses {
  public:
    explicit AndersonPasses(std::size_t count);

    /// Takes in x and T(x), of which `history` earlier ones count.
    AndersonSums sums(std::span<const gpu::vec4> x, std::span<const gpu::vec4> next,
                      const AndersonSlots& slots, std::uint32_t history);

    /// x becomes T(x) less its part along earlier iterates' changes.
    void mix(std::span<gpu::vec4> x, std::span<const gpu::vec4> next, const AndersonSlots& slots,
             const std::array<float, 3>& weights);

  private:
    std::array<std::vector<float>, 4> residuals_;  // by slot
    std::array<std::vector<gpu::vec4>, 4> past_;   // T(x) by slot
};

}  // namespace glowworm
