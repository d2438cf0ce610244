#pragma once

#include <cstdint>
#include <filesystem>

#include "octree/build.h"
#include "octree/surfel_stream.h"

namespace glowworm {

struct MemorySettings {
    std::uint64_t limit = 0;  ///< bytes the whole program may use, 0: what the system has left
    std::filesystem::path temporary_folder = {};  ///< for what does not fit; empty: beside output
};

/// Bytes of memory that a program that builds `surfels` at once takes, measured with some room.
std::uint64_t memory_to_build(std::uint64_t surfels);

struct BuildFileReport {
    Grid grid;
    std::uint64_t samples = 0, dropped = 0;
    std::uint32_t tiles = 0;          ///< 0: built at once
    std::uint64_t spilled_bytes = 0;  ///< written to the temporary folder
    std::uint64_t memory_limit = 0;   ///< kept to: the one given or what the system had left
};

/// Builds an octree file, or with `settings.tile` one tile of it, from a stream, within the memory
/// limit: what does not fit is spread over cells of the grid, each cell built by itself and all of
/// them joined. The bytes do not depend on the limit. Throws Error as build_octree does, and
/// kBudget, saying what it needs, where the limit leaves less than 48 MB to work in, where one cell
/// has more points than fit, where points without radius do not fit (their spacing needs all of
/// them), or where the disk is full. Temporary files are removed, whatever happens.
BuildFileReport build_octree_file(const SurfelStream& stream, const BuildSettings& settings,
                                  const MemorySettings& memory, const std::filesystem::path& path,
                                  const Progress& progress = {});

}  // namespace glowworm
