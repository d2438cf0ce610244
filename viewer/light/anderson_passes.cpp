#include "viewer/light/anderson_passes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace glowworm {

namespace {

constexpr std::size_t kBlock = 1024;  // summed up one after the other
constexpr float kMost = 1e30f;        // anderson_mix.comp

float luminance(const gpu::vec4& c) {
    return c.x * 0.2126f + c.y * 0.7152f + c.z * 0.0722f;
}

template <typename Visit>
void for_each_block(std::size_t count, const Visit& visit) {
    tbb::parallel_for(std::size_t{0}, (count + kBlock - 1) / kBlock, [&](std::size_t block) {
        visit(block, block * kBlock, std::min(count, (block + 1) * kBlock));
    });
}

}  // namespace

AndersonPasses::AndersonPasses(std::size_t count) {
    for (auto& slot : residuals_)
        slot.resize(count);
    for (auto& slot : past_)
        slot.resize(count);
}

AndersonSums AndersonPasses::sums(std::span<const gpu::vec4> x, std::span<const gpu::vec4> next,
                                  const AndersonSlots& slots, std::uint32_t history) {
    const std::size_t count = residuals_[0].size();
    std::vector<AndersonSums> of_blocks((count + kBlock - 1) / kBlock);
    for_each_block(count, [&](std::size_t block, std::size_t first, std::size_t last) {
        AndersonSums sums{};
        for (std::size_t i = first; i < last; ++i) {
            const float had = luminance(x[i]);
            const float r = luminance(next[i]) - had;
            residuals_[slots[0]][i] = r;
            float d[3];
            for (std::uint32_t j = 0; j < 3; ++j)
                d[j] = j < history ? r - residuals_[slots[j + 1]][i] : 0.0f;
            const float change = std::abs(r);
            const float terms[] = {
                d[0] * d[0], d[0] * d[1], d[0] * d[2],
                d[1] * d[1], d[1] * d[2], d[2] * d[2],
                d[0] * r,    d[1] * r,    d[2] * r,
                r * r,       had * had,   change > 0.0f ? change / std::max(had, change) : 0.0f};
            for (std::size_t s = 0; s < sums.size(); ++s)
                sums[s] += terms[s];
        }
        of_blocks[block] = sums;
    });
    AndersonSums all{};
    for (const AndersonSums& of_block : of_blocks) {
        for (std::size_t s = 0; s < all.size(); ++s)
            all[s] += of_block[s];
    }
    return all;
}

void AndersonPasses::mix(std::span<gpu::vec4> x, std::span<const gpu::vec4> next,
                         const AndersonSlots& slots, const std::array<float, 3>& weights) {
    for_each_block(past_[0].size(), [&](std::size_t, std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            const gpu::vec4 now = next[i];
            gpu::vec4 mixed = now;
            for (std::size_t j = 0; j < 3; ++j) {
                if (weights[j] != 0.0f) mixed -= weights[j] * (now - past_[slots[j + 1]][i]);
            }
            past_[slots[0]][i] = now;
            const auto bounded = [](float v) {
                return std::min(std::max(0.0f, v), kMost);
            };  // NaN: 0
            x[i] = {bounded(mixed.x), bounded(mixed.y), bounded(mixed.z), 0.0f};
        }
    });
}

}  // namespace glowworm
