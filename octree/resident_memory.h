#pragma once

#include <cstdint>

namespace glowworm {

/// What this program occupies now, mapped files that it has read included; 0 where the system does
/// not say.
std::uint64_t resident_bytes();

/// What this program may come to occupy: what it does now and nine tenths of what the system could
/// still give it by putting its caches aside, within the limits set on it (control groups,
/// `ulimit -d` and `-v`). Without end where the system does not say.
std::uint64_t memory_left();

}  // namespace glowworm
