#pragma once

#include <cstdint>
#include <vector>

namespace glowworm {

/// A Morton code and what it belongs to.
struct CodeIndex {
    std::uint64_t code;
    std::uint32_t index;
    std::uint32_t part;  ///< free for the caller's use
};
static_assert(sizeof(CodeIndex) == 16);

/// Sorts by code, stably, in parallel: equal codes stay in the order they came in, so the result is
/// the same on any number of threads. Needs as much memory again while it runs. Linear in the
/// number of entries: byte by byte from the low end, bytes that all codes share are passed over.
void radix_sort(std::vector<CodeIndex>& entries);

}  // namespace glowworm
