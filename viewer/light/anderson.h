#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/light/anderson_passes.h"

namespace glowworm {

/// Anderson acceleration of the bounces x <- T(x) over 3 earlier iterates (Walker and Ni 2011), on
/// luminance with one set of weights for all channels. It falls back to the plain bounce, which
/// always converges, when the residual grows or the least squares is not finite.
class Anderson {
  public:
    /// Of so many lobes, or groups of them; by compiled code or by shaders.
    Anderson(std::size_t count, bool compiled);

    /// What a bounce changes, before it is taken.
    struct Change {
        double norm = 0.0;      ///< |T(x) - x| / |x|
        double relative = 0.0;  ///< mean over lobes of |T(x) - x| / T(x)
    };

    /// One step from x, to which T(x) belongs: x becomes the next one.
    Change step(const Buffer& x, const Buffer& next);
    void forget();  ///< clears the history: what T is has changed

  private:
    struct Shaders {
        Program sums, mix;
        Buffer partial_sums, residuals, past;
    };
    AndersonSums sums(const Buffer& x, const Buffer& next);
    void mix(const Buffer& x, const Buffer& next, const std::array<float, 3>& weights);

    std::size_t count_;
    std::optional<AndersonPasses> compiled_;
    std::optional<Shaders> shaders_;
    AndersonSlots slots_{0, 1, 2, 3};
    std::uint32_t history_ = 0;
    double last_residual_ = 0.0;
};

/// Weights that make |r - sum g_j d_j| least: `products` are <d_i, d_j> as 00 01 02 11 12 22, then
/// <d_j, r>. All zero where there is no finite solution.
std::array<float, 3> anderson_weights(const std::array<double, 9>& products, std::size_t history);

}  // namespace glowworm
