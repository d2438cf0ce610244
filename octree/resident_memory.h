#pragma once

#include <cstdint>

namespace glowworm {

/// What this program occupies now, mapped files that it has read included; 0 where the system does
/// not say.
std::uint64_t resident_bytes();

/// What the system could still give to programs, by putting its caches aside; 0 where it does not
/// say.
std::uint64_t available_bytes();

}  // namespace glowworm
