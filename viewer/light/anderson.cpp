#include "viewer/light/anderson.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shaders/gpu_layout.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::size_t kSums = 12;  // per group, in the order of anderson_sums.comp
constexpr std::size_t kSlots = 4;
constexpr double kTikhonov = 1e-8;       // of the trace
constexpr double kResidualGrowth = 2.0;  // more than that and the history misleads
constexpr float kMostWeight = 1e4f;

}  // namespace

std::array<float, 3> anderson_weights(const std::array<double, 9>& products, std::size_t history) {
    // Gaussian elimination with the right-hand side as a fourth column. The matrix is symmetric and
    // positive definite after regularisation, so no pivoting is needed.
    double m[3][4] = {{products[0], products[1], products[2], products[6]},
                      {products[1], products[3], products[4], products[7]},
                      {products[2], products[4], products[5], products[8]}};
    double trace = 0.0;
    for (std::size_t i = 0; i < history; ++i)
        trace += m[i][i];
    std::array<float, 3> weights{};
    if (!(trace > 0.0) || !std::isfinite(trace)) return weights;
    for (std::size_t i = 0; i < history; ++i)
        m[i][i] += kTikhonov * trace;
    for (std::size_t i = 0; i < history; ++i) {
        for (std::size_t j = i + 1; j < history; ++j) {
            const double factor = m[j][i] / m[i][i];
            for (std::size_t k = i; k < 4; ++k)
                m[j][k] -= factor * m[i][k];
        }
    }
    std::array<double, 3> solution{};
    for (std::size_t i = history; i-- > 0;) {
        double rest = m[i][3];
        for (std::size_t k = i + 1; k < history; ++k)
            rest -= m[i][k] * solution[k];
        solution[i] = rest / m[i][i];
        weights[i] = static_cast<float>(solution[i]);
    }
    for (const float weight : weights) {
        if (!(std::abs(weight) <= kMostWeight)) return {};
    }
    return weights;
}

Anderson::Anderson(std::size_t lobes)
    : lobes_(lobes),
      sums_({"anderson_sums.comp"}),
      mix_({"anderson_mix.comp"}),
      partial_sums_("anderson sums", (lobes + kGroup - 1) / kGroup * kSums * sizeof(float)),
      residuals_("anderson residuals", lobes * kSlots * sizeof(float)),
      past_("anderson history", lobes * kSlots * 4 * sizeof(float)) {
    for (const Program* program : {&sums_, &mix_})
        set_uniform(*program, 5, static_cast<std::uint32_t>(lobes));
}

void Anderson::forget() {
    history_ = 0;
}

Anderson::Change Anderson::step() {
    partial_sums_.bind_storage(BINDING_SCRATCH_A);
    residuals_.bind_storage(BINDING_SCRATCH_C);
    set_uniform(sums_, 0, history_);
    glProgramUniform1uiv(sums_.name(), 1, kSlots, slots_.data());
    sums_.dispatch(lobes_, kGroup);

    const std::size_t groups = (lobes_ + kGroup - 1) / kGroup;
    const std::vector<float> partial = partial_sums_.read<float>(groups * kSums);
    std::array<double, kSums> sums{};
    for (std::size_t i = 0; i < partial.size(); ++i)
        sums[i % kSums] += partial[i];

    std::array<double, 9> products{};
    std::copy_n(sums.begin(), 9, products.begin());
    const double residual = std::sqrt(sums[9]);
    const bool misled =
        !std::isfinite(residual) || (history_ > 0 && residual > kResidualGrowth * last_residual_);
    if (misled) history_ = 0;
    last_residual_ = residual;
    const std::array<float, 3> weights = anderson_weights(products, history_);

    past_.bind_storage(BINDING_SCRATCH_C);
    glProgramUniform3fv(mix_.name(), 0, 1, weights.data());
    glProgramUniform1uiv(mix_.name(), 1, kSlots, slots_.data());
    mix_.dispatch(lobes_, kGroup);

    std::rotate(slots_.begin(), slots_.begin() + kSlots - 1, slots_.end());
    history_ = std::min<std::uint32_t>(history_ + 1, kSlots - 1);
    const double norm = std::sqrt(sums[10]);
    return {norm > 0.0       ? residual / norm
            : residual > 0.0 ? 1.0
                             : 0.0,
            lobes_ > 0 ? sums[11] / static_cast<double>(lobes_) : 0.0};
}

}  // namespace glowworm
