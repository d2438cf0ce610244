#include "octree/radix_sort.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <vector>

namespace glowworm {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 17;  ///< entries a task counts and then scatters
constexpr std::size_t kDigits = 256;
constexpr std::size_t kSmall = 2048;  ///< below this std::stable_sort is faster

using Histogram = std::array<std::uint32_t, kDigits>;

}  // namespace

void radix_sort(CodeIndices& entries) {
    const auto by_code = [](const CodeIndex& a, const CodeIndex& b) { return a.code < b.code; };
    if (entries.size() < kSmall) {
        std::stable_sort(entries.begin(), entries.end(), by_code);
        return;
    }

    std::uint64_t differing = 0;
    for (const CodeIndex& entry : entries)
        differing |= entry.code ^ entries.front().code;

    const std::size_t blocks = (entries.size() + kBlock - 1) / kBlock;
    std::vector<Histogram> offsets(blocks);
    CodeIndices other(entries.size());
    while (differing != 0) {
        const int shift = std::countr_zero(differing);
        const auto digit = [shift](const CodeIndex& entry) {
            return static_cast<std::size_t>(entry.code >> shift & (kDigits - 1));
        };
        const auto for_each_block = [&](const auto& body) {
            tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
                body(offsets[block], block * kBlock,
                     std::min(entries.size(), (block + 1) * kBlock));
            });
        };

        for_each_block([&](Histogram& counts, std::size_t begin, std::size_t end) {
            counts.fill(0);
            for (std::size_t i = begin; i < end; ++i)
                ++counts[digit(entries[i])];
        });
        std::uint32_t next = 0;
        for (std::size_t d = 0; d < kDigits; ++d) {
            for (Histogram& counts : offsets) {
                const std::uint32_t here = counts[d];
                counts[d] = next;
                next += here;
            }
        }
        for_each_block([&](Histogram& places, std::size_t begin, std::size_t end) {
            Histogram local = places;
            for (std::size_t i = begin; i < end; ++i)
                other[local[digit(entries[i])]++] = entries[i];
        });
        entries.swap(other);
        differing &= shift + 8 < 64 ? ~std::uint64_t{0} << (shift + 8) : 0;
    }
}

}  // namespace glowworm
