#pragma once

#include <cstdint>
#include <string>

namespace glowworm {

/// "512M", "8G", "1.5GiB", "2000000": bytes. K, M, G and T (with or without B) are powers of 1000,
/// KiB, MiB, GiB and TiB of 1024, in either case. Throws Error (kUsage) for what is not a positive
/// size.
std::uint64_t parse_size(const std::string& text);

/// Asks the system to refuse memory beyond `bytes`, so that a prediction that was wrong ends in
/// std::bad_alloc and not in a peak above the limit. Some of the limit stands for the program
/// itself and for the stacks of `threads` threads. 0 bytes: nothing is asked. Throws Error
/// (kBudget) for less than the program takes before any work.
void limit_memory(std::uint64_t bytes, int threads);

/// The same where large blocks are paged (paged_memory.h): a quarter of the limit is left to their
/// pages, which the system does not count.
void limit_memory_beside_pages(std::uint64_t bytes, int threads);

}  // namespace glowworm
