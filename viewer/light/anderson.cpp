#include "viewer/light/anderson.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "shaders/gpu_layout.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::size_t kSums = std::tuple_size_v<AndersonSums>;  // of a group
constexpr std::size_t kSlots = std::tuple_size_v<AndersonSlots>;
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

Anderson::Anderson(std::size_t count, bool compiled) : count_(count) {
    if (compiled) {
        compiled_.emplace(count);
        return;
    }
    const std::size_t groups = (count + kGroup - 1) / kGroup;
    shaders_.emplace(Shaders{Program({"anderson_sums.comp"}), Program({"anderson_mix.comp"}),
                             Buffer("anderson sums", groups * kSums * sizeof(float)),
                             Buffer("anderson residuals", count * kSlots * sizeof(float)),
                             Buffer("anderson history", count * kSlots * sizeof(gpu::vec4))});
    for (const Program* program : {&shaders_->sums, &shaders_->mix})
        set_uniform(*program, 5, static_cast<std::uint32_t>(count));
}

void Anderson::forget() {
    history_ = 0;
}

AndersonSums Anderson::sums(const Buffer& x, const Buffer& next) {
    if (compiled_)
        return compiled_->sums(x.map<const gpu::vec4>(), next.map<const gpu::vec4>(), slots_,
                               history_);
    x.bind_storage(BINDING_INDIRECT);
    next.bind_storage(BINDING_SCRATCH_B);
    shaders_->partial_sums.bind_storage(BINDING_SCRATCH_A);
    shaders_->residuals.bind_storage(BINDING_SCRATCH_C);
    set_uniform(shaders_->sums, 0, history_);
    glProgramUniform1uiv(shaders_->sums.name(), 1, kSlots, slots_.data());
    shaders_->sums.dispatch(count_, kGroup);

    const std::size_t groups = (count_ + kGroup - 1) / kGroup;
    const std::vector<float> partial = shaders_->partial_sums.read<float>(groups * kSums);
    AndersonSums sums{};
    for (std::size_t i = 0; i < partial.size(); ++i)
        sums[i % kSums] += partial[i];
    return sums;
}

void Anderson::mix(const Buffer& x, const Buffer& next, const std::array<float, 3>& weights) {
    if (compiled_) {
        compiled_->mix(x.map<gpu::vec4>(), next.map<const gpu::vec4>(), slots_, weights);
        return;
    }
    shaders_->past.bind_storage(BINDING_SCRATCH_C);
    glProgramUniform3fv(shaders_->mix.name(), 0, 1, weights.data());
    glProgramUniform1uiv(shaders_->mix.name(), 1, kSlots, slots_.data());
    shaders_->mix.dispatch(count_, kGroup);
}

Anderson::Change Anderson::step(const Buffer& x, const Buffer& next) {
    const AndersonSums sums = this->sums(x, next);
    std::array<double, 9> products{};
    std::copy_n(sums.begin(), 9, products.begin());
    const double residual = std::sqrt(sums[9]);
    const bool misled =
        !std::isfinite(residual) || (history_ > 0 && residual > kResidualGrowth * last_residual_);
    if (misled) history_ = 0;
    last_residual_ = residual;
    mix(x, next, anderson_weights(products, history_));

    std::rotate(slots_.begin(), slots_.begin() + kSlots - 1, slots_.end());
    history_ = std::min<std::uint32_t>(history_ + 1, kSlots - 1);
    const double norm = std::sqrt(sums[10]);
    return {norm > 0.0       ? residual / norm
            : residual > 0.0 ? 1.0
                             : 0.0,
            count_ > 0 ? sums[11] / static_cast<double>(count_) : 0.0};
}

}  // namespace glowworm
