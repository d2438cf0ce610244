#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "preprocess/plot/picture.h"
#include "preprocess/poses.h"
#include "preprocess/scan.h"

namespace glowworm {

/// All placed scans from above: a colour each, bright where many points lie over
/// one another, stations as ringed discs with their numbers, a scale bar of a round length and an
/// arrow along Y ("north" where the poses have an origin, as in a national grid), and beside the
/// map the scans' names, those that are not placed in red. The map's longer side is `pixels`
/// (64..8192) long. Throws Error kUsage for a size out of range, kDegenerate where no scan is
/// placed.
Picture draw_plan_view(std::span<const Scan> scans, const Poses& poses,
                       std::uint32_t pixels = 1200);

/// The same as a PNG. Throws Error kUnreadable as well, where the file cannot be written.
void write_plan_view(std::span<const Scan> scans, const Poses& poses,
                     const std::filesystem::path& file, std::uint32_t pixels = 1200);

}  // namespace glowworm
