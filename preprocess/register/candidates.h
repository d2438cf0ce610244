#pragma once

#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "preprocess/register/align.h"
#include "preprocess/register/assembly.h"

namespace glowworm {

/// Pairs (target, source), target < source, that are worth an attempt from nothing: those in
/// different groups and not believed yet. With many scans only each one's most promising partners,
/// by what both scans say at a glance to the guesses that their most distinctive keypoints lead to
/// (a tenth of the work of an attempt).
std::vector<std::pair<std::size_t, std::size_t>> candidate_pairs(
    std::span<const ScanModel> models, std::span<const PairFit> pairs, const Assembly& assembly,
    const PairSettings& pair_settings, const RegistrationSettings& settings);

}  // namespace glowworm
