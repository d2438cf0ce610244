#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "preprocess/pipeline.h"

namespace glowworm {

struct PairFit;

/// One of `parts` equal parts of a stage, for one of as many jobs.
struct Share {
    std::uint32_t part = 1;   ///< 1..parts
    std::uint32_t parts = 1;  ///< 1..9999

    /// "pairs-2of8"
    std::string name(const std::string& stage) const;
};

/// "2/8". Throws Error (kUsage) for what is no such part.
Share parse_share(const std::string& text);

/// Finds out which pairs registration will try from nothing, and keeps it in the work folder;
/// returns how many. Takes it from there where it is kept.
std::size_t plan_share_of_pairs(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                                const Phases& begin, const WorkFolder& work);

/// Tries a share of these pairs and keeps what came of it; returns how many. Nothing is done where
/// that is kept. Reads only the scans it needs.
std::size_t try_share_of_pairs(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                               const Phases& begin, const WorkFolder& work, const Share& share);

/// The pairs that jobs have tried, for a registration of that key.
std::vector<PairFit> tried_pairs(const WorkFolder& work, const std::string& key);

/// Builds a share of the octree's tiles from the surfels that are kept, and keeps them; returns how
/// many. Nothing is done where they are kept. Throws Error (kUsage) where no surfels are.
std::size_t build_share_of_tiles(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                                 const Phases& begin, const WorkFolder& work, const Share& share);

/// Joins the tiles that jobs built to the octree at `output`: the same bytes as one build. False
/// where they are not all there.
bool join_tiles(const WorkFolder& work, const std::string& key, const std::string& provenance,
                const std::filesystem::path& output, const Phases& begin, Conversion& so_far);

}  // namespace glowworm
