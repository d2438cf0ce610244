#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace glowworm {

/// CRC-32C (Castagnoli; RFC 3720, appendix B.4) of `bytes`, by the processor's own instruction
/// where it has one. "123456789" has 0xe3069283.
std::uint32_t crc32c(std::span<const std::byte> bytes);

/// As above, by tables on every processor.
std::uint32_t crc32c_by_tables(std::span<const std::byte> bytes);

}  // namespace glowworm
