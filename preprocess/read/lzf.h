#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace glowworm {

/// No LZF stream expands by more than this: a reference of 3 bytes yields at most 264.
inline constexpr std::size_t kLzfLargestExpansion = 88;

/// Decodes an LZF stream (Marc Lehmann's LibLZF, as PCL uses it). True where it is well formed and
/// fills `output` exactly.
bool decode_lzf(std::span<const std::byte> input, std::span<std::byte> output);

/// Encodes `input` as an LZF stream; longer than the input where that does not repeat itself.
std::vector<std::byte> encode_lzf(std::span<const std::byte> input);

}  // namespace glowworm
