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
#include "preprocess/provenance.h"
#include "preprocess/read/preflight.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/register/align.h"
#include "preprocess/surface/surface.h"

namespace glowworm {

class WorkFolder;

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
    std::uint32_t links = 0;             ///< rays per lobe to trace and keep in the file
};

/// The stages, each of which keeps what it made.
enum class Stage { kIngest, kRegister, kMerge, kSurface, kBuild };

/// A file of scans and what its content is.
struct ScanInput {
    std::filesystem::path path;
    InputFile content;
};

/// What each stage had to say.
struct Conversion {
    std::vector<Warning> warnings;
    std::size_t scans = 0;
    std::uint64_t points = 0;    ///< read
    std::uint64_t outliers = 0;  ///< removed
    Registration registration;
    MergeReport merge;
    SurfaceReport surface;
};

/// Begins a phase of a name and a unit; the function returned takes its progress.
using Phases = std::function<Progress(const std::string& phase, const std::string& unit)>;

/// The scans of all files, cleaned, each knowing whether its origin is where a scanner stood.
std::vector<Scan> read_clean_scans(std::span<const std::filesystem::path> files,
                                   const ConvertSettings& settings, const Phases& begin,
                                   Conversion& conversion);

/// Hash of every setting that decides the result, 32 hexadecimal digits: two conversions of the
/// same inputs and the same hash give the same bytes.
std::string settings_hash(const ConvertSettings& settings);

/// The key under which ingest keeps what it makes of `input`.
std::string ingest_key(const ScanInput& input, const ConvertSettings& settings);

/// Turns raw scans into an octree file without links, octree_part(work). What an earlier run kept
/// in the work folder is taken from there where inputs and settings are the same, so that only what
/// changed is worked on. Ends after the stage `until`. `registered` is called once poses are known,
/// before a registration that cannot be trusted ends the work. Throws Error kNotTrustworthy where a
/// scan could not be placed and allow_missing_scans is not set, and whatever its stages throw.
Conversion convert_scans(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                         const Phases& begin,
                         const std::function<void(const Registration&)>& registered,
                         const WorkFolder& work, Stage until = Stage::kBuild);

/// The octree without links that the build keeps.
std::filesystem::path octree_part(const WorkFolder& work);

/// What the stages up to the registration had to say, as the last run kept it; false where it did
/// not.
bool load_registration(const WorkFolder& work, Conversion& kept);

/// The poses that an earlier run found and kept, as the text of a poses.json; empty where there are
/// none.
std::string kept_poses(const WorkFolder& work);

}  // namespace glowworm
