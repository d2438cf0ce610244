#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "octree/build.h"
#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/surfel.h"
#include "preprocess/provenance.h"
#include "preprocess/read/preflight.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/register/align.h"
#include "preprocess/surface/surface.h"

namespace glowworm {

/// --poses FILE|trust|refine|ignore (repeatable: a file and a word), --upright.
struct RegistrationFlags {
    std::vector<std::string> poses;
    bool upright = false;

    void add_to(CLI::App& command);

    /// Throws what read_poses throws, and kUsage for a word that is neither a mode nor a file.
    void apply(RegistrationSettings& settings) const;
};

/// --depth, --voxel-size, --lights, --links.
struct BuildFlags {
    std::optional<std::uint32_t> depth;
    std::optional<double> voxel_size;
    std::filesystem::path lights;
    std::uint32_t links = 0;  ///< rays per lobe to trace and keep in the file; 0: none

    void add_to(CLI::App& command);
    std::vector<AreaLight> area_lights() const;

    /// With the provenance of a file that `command` makes from `inputs`.
    BuildSettings settings(const std::string& command,
                           const std::vector<std::filesystem::path>& inputs) const;

    /// The same for inputs that are described already; `settings` as for provenance_json.
    BuildSettings settings(const std::string& command, std::vector<InputFile> inputs,
                           const std::string& settings) const;
};

/// A number within the range; never NaN, which CLI::Range lets pass.
CLI::Validator finite(double low, double high);

void add_read_flags(CLI::App& command, ReadSettings& settings);
void add_surface_flags(CLI::App& command, SurfaceSettings& settings);

nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings);
nlohmann::ordered_json surface_json(const SurfaceReport& report);

/// What was found and decided, for people, in the log.
void say_warnings(const std::vector<Warning>& warnings);
void say_surface(const SurfaceReport& report);
void say_octree(const OctreeView& octree);
void say_trust(const Registration& registration);

}  // namespace glowworm
