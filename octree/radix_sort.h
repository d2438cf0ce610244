#pragma once

#include <cstddef>
#include <cstdint>

#include "octree/unfilled.h"

namespace glowworm {

/// A Morton code and what it belongs to.
struct CodeIndex {
    std::uint64_t code;
    std::uint32_t index;
    std::uint32_t part;  ///< free for the caller's use
};
static_assert(sizeof(CodeIndex) == 16);

using CodeIndices = Unfilled<CodeIndex>;

/// Sorts by code, stably, in parallel: equal codes stay in the order they came in, so the result is
/// the same on any number of threads. Needs as much memory again while it runs. Linear in the
/// number of entries: byte by byte from the low end, bytes that all codes share are passed over.
void radix_sort(CodeIndices& entries);

/// Surfels are read in sorted order, wherever they lie: how far ahead to ask for them.
inline constexpr std::size_t kPrefetchAhead = 24;

/// Asks for the two cache lines that a 64-byte record may span.
inline void prefetch(const void* record) {
    __builtin_prefetch(record);
    __builtin_prefetch(static_cast<const char*>(record) + 63);
}

}  // namespace glowworm
