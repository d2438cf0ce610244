#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "octree/build.h"
#include "octree/progress.h"
#include "octree/surfel.h"
#include "preprocess/clean.h"
#include "preprocess/merge.h"
#include "preprocess/read/preflight.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/register/align.h"
#include "preprocess/surface/surface.h"

namespace glowworm {

/// One struct per stage, each with its defaults in its own header.
struct ConvertSettings {
    ReadSettings read;
    CleanSettings clean;
    RegistrationSettings registration;
    MergeSettings merge;
    SurfaceSettings surface;
    BuildSettings build;
    std::vector<AreaLight> area_lights;  ///< put into the tree, each with its own index
    bool allow_missing_scans = false;    ///< go on without scans that could not be placed
};

/// What each stage did.
struct Conversion {
    std::vector<Warning> warnings;
    std::size_t scans = 0;
    std::uint64_t points = 0;    ///< read
    std::uint64_t outliers = 0;  ///< removed
    Registration registration;
    MergeReport merge;
    SurfaceReport surface;
    Octree octree;
};

/// Begins a phase of a name and a unit; the function returned takes its progress.
using Phases = std::function<Progress(const std::string& phase, const std::string& unit)>;

/// The scans of all files, cleaned, each knowing whether its origin is where a scanner stood.
std::vector<Scan> read_clean_scans(std::span<const std::filesystem::path> files,
                                   const ConvertSettings& settings, const Phases& begin,
                                   Conversion& conversion);

/// Turns raw scans into an octree, in memory. `report` is called as soon as poses are there, before
/// a registration that cannot be trusted ends the work. Throws Error kNotTrustworthy where a scan
/// could not be placed and allow_missing_scans is not set, and whatever its stages throw.
Conversion convert_scans(std::span<const std::filesystem::path> files,
                         const ConvertSettings& settings, const Phases& begin,
                         const std::function<void(const Registration&)>& report);

}  // namespace glowworm
