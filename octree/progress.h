#pragma once

#include <cstdint>
#include <functional>

namespace glowworm {

/// Called by long work with how much is done of a total, in the work's own unit (points, pairs,
/// bytes). Calls come from one thread at a time. It may throw to cancel the work. Empty: nobody
/// listens.
using Progress = std::function<void(std::uint64_t done, std::uint64_t total)>;

}  // namespace glowworm
