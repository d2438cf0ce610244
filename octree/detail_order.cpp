#include <array>
#include <bit>

#include "octree/chunk.h"

namespace glowworm {
namespace {

/// Levels that two codes share, 0..16.
std::uint32_t common_levels(std::uint64_t a, std::uint64_t b) {
    const int leading = std::countl_zero((a ^ b) << 16 | 0x8000);
    return static_cast<std::uint32_t>(leading) / 3;
}

/// Squared distance of a point from the centre of its cell at `level`, in quantisation steps.
std::uint64_t centre_distance(std::uint64_t code, std::uint32_t level) {
    const CellIndex q = morton_decode(code);
    const std::uint32_t bits = kCodeLevels - level;
    const auto axis = [&](std::uint32_t v) {
        const std::int64_t twice =
            2 * static_cast<std::int64_t>(v & ((1u << bits) - 1)) + 1 - (std::int64_t{1} << bits);
        return static_cast<std::uint64_t>(twice * twice);
    };
    return axis(q.x) + axis(q.y) + axis(q.z);
}

/// Level from which each point is shown: a knockout over the tree of common prefixes, in one sweep.
std::vector<std::uint8_t> first_levels(std::span<const std::uint64_t> codes) {
    struct Standing {
        std::uint32_t point;
        std::uint32_t shared;  ///< levels shared with the one below it on the stack
    };
    std::vector<std::uint8_t> levels(codes.size(), 0);
    std::vector<Standing> stack;
    const auto meet = [&] {
        const Standing challenger = stack.back();
        stack.pop_back();
        Standing& holder = stack.back();
        const std::uint32_t cell = challenger.shared;
        const bool holds = centre_distance(codes[holder.point], cell) <=
                           centre_distance(codes[challenger.point], cell);
        levels[holds ? challenger.point : holder.point] = static_cast<std::uint8_t>(cell + 1);
        if (!holds) holder.point = challenger.point;
    };
    for (std::uint32_t i = 0; i < codes.size(); ++i) {
        const std::uint32_t shared = i == 0 ? 0 : common_levels(codes[i - 1], codes[i]);
        while (stack.size() > 1 && stack.back().shared > shared)
            meet();
        stack.push_back({i, shared});
    }
    while (stack.size() > 1)
        meet();
    return levels;
}

std::uint32_t reverse_bits(std::uint32_t v, int bits) {
    v = (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
    v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
    v = (v >> 4 & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4;
    v = (v >> 8 & 0x00ff00ffu) | (v & 0x00ff00ffu) << 8;
    v = v >> 16 | v << 16;
    return bits == 0 ? 0 : v >> (32 - bits);
}

}  // namespace

std::vector<std::uint32_t> detail_order(std::span<const std::uint64_t> codes) {
    const std::vector<std::uint8_t> levels = first_levels(codes);

    std::array<std::uint32_t, kCodeLevels + 3> starts{};
    for (const std::uint8_t level : levels)
        ++starts[level + 1u];
    for (std::size_t l = 1; l < starts.size(); ++l)
        starts[l] += starts[l - 1];
    std::vector<std::uint32_t> by_level(codes.size());
    auto next = starts;
    for (std::uint32_t i = 0; i < codes.size(); ++i)
        by_level[next[levels[i]]++] = i;

    std::vector<std::uint32_t> order;
    order.reserve(codes.size());
    for (std::size_t l = 0; l + 1 < starts.size(); ++l) {
        const std::uint32_t count = starts[l + 1] - starts[l];
        if (count == 0) continue;
        const int bits = std::bit_width(count - 1);
        for (std::uint32_t i = 0; i < 1u << bits; ++i) {
            const std::uint32_t place = reverse_bits(i, bits);
            if (place < count) order.push_back(by_level[starts[l] + place]);
        }
    }
    return order;
}

}  // namespace glowworm
