#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <vector>

#include "octree/progress.h"
#include "preprocess/read/scan_facts.h"
#include "preprocess/scan.h"

namespace glowworm {

/// A scan as its file's points show it, without keeping them all.
struct LookedScan {
    Scan sample;      ///< up to kLookedPoints positions spread evenly over the scan's, no columns
    ScanFacts facts;  ///< the spacing excepted, which pick_points finds
    std::vector<Vec3d> places;  ///< m, some points from which the nearest others are looked for
};

inline constexpr std::size_t kLookedPoints = 45000;

/// Reads every file once, as a stream: memory does not depend on their size. Throws as
/// open_scan_file.
std::vector<LookedScan> look_at(std::span<const std::filesystem::path> files,
                                const ReadSettings& settings, const Progress& progress);

/// Whether a point of scan number `scan` is wanted; `position` in the scan's frame, m.
using Wanted = std::function<bool(std::size_t scan, const Vec3d& position)>;

/// Reads every file again: the wanted points of each scan with all their columns, and the scans'
/// spacings, which go into `looked`. Scans as there.
std::vector<Scan> pick_points(std::span<const std::filesystem::path> files,
                              const ReadSettings& settings, std::vector<LookedScan>& looked,
                              const Wanted& wanted, const Progress& progress);

}  // namespace glowworm
