#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "octree/progress.h"
#include "preprocess/poses.h"
#include "preprocess/scan.h"

namespace glowworm {

/// What to do with poses that are given (by the files or by a poses.json).
enum class PriorMode {
    kTrust,   ///< keep them; the report says how well they fit
    kRefine,  ///< start from them
    kIgnore,  ///< register from nothing
};

struct RegistrationSettings {
    PriorMode mode = PriorMode::kRefine;
    std::optional<Poses> prior =
        std::nullopt;         ///< a poses.json; goes before the poses in the files
    bool upright = false;     ///< scanners are levelled: only yaw and position are sought
    double voxel_size = 0.0;  ///< m, of the coarse surface samples; 0: from the scans' extent
    std::uint32_t max_scans = 1000;         ///< more is refused with a sentence
    std::uint32_t candidates_per_scan = 8;  ///< partners tried per scan where there are many
    std::vector<std::pair<std::size_t, std::size_t>> pairs = {};  ///< known pairs; empty: sought
};

struct Registration {
    Poses poses;
    double voxel_size = 0;  ///< m, used
    std::size_t pairs_tried = 0;
    std::size_t unregistered = 0;
    /// Scans that can shift or turn along an axis that neither a chain of pairs nor a given pose
    /// holds: indices, ascending. Their weak_axes say which.
    std::vector<std::size_t> loose;

    /// Every scan is placed and held in every direction: else the command ends with exit code 5.
    bool trustworthy() const { return unregistered == 0 && loose.empty(); }
};

struct PairFit;

/// Which pairs registration would try from nothing, so that they can be tried one by one and
/// elsewhere.
struct PairPlan {
    double voxel_size = 0;                                   ///< m, for all pairs
    bool all_seen = false;                                   ///< every scan has a viewpoint
    std::vector<std::pair<std::size_t, std::size_t>> pairs;  ///< target, source
};

/// Throws as align_scans.
PairPlan plan_pairs(std::span<const Scan> scans, const RegistrationSettings& settings,
                    const Progress& progress = {});

/// Tries some of the plan's pairs. Scans that none of them names may be empty.
std::vector<PairFit> try_pairs(std::span<const Scan> scans, const RegistrationSettings& settings,
                               const PairPlan& plan,
                               std::span<const std::pair<std::size_t, std::size_t>> pairs,
                               const Progress& progress = {});

/// Finds the pose of every scan. The world frame is that of the scans' given poses, else the
/// frame of the reference scan, so that a levelled scanner's Z stays up. Scans that cannot be
/// placed stay kUnregistered. One scan alone is its own reference. Same input, same result on any
/// number of threads. Pairs that were `tried` are not tried again. Throws Error kDegenerate where
/// there is no scan or one has no points, kUsage for settings out of range.
Registration align_scans(std::span<const Scan> scans, const RegistrationSettings& settings,
                         const Progress& progress = {}, std::span<const PairFit> tried = {});

/// The trust report as a table for people: a line per scan, a line per accepted pair. "-" where
/// nothing was measured: a scan without pairs, a misclosure where no loop closes.
std::string trust_table(const Registration& registration);

/// What speaks against the result, naming the scans: half a sentence; empty where it is
/// trustworthy.
std::string distrust(const Registration& registration);

}  // namespace glowworm
