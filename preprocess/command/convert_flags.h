#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/command/stage_flags.h"
#include "preprocess/pipeline.h"

namespace glowworm {

/// What `convert`, and `ingest` for a part of its work, are told.
struct ConvertFlags {
    std::vector<std::filesystem::path> inputs;
    ConvertSettings settings;
    RegistrationFlags registration;
    BuildFlags build;
    std::string until = "links";   ///< the last stage to do
    std::filesystem::path report;  ///< an HTML page of the run, empty: none

    void add_to(CLI::App& command);

    /// Brings what the flags say into `settings`, provenance excepted.
    void apply();

    /// Brings into `settings` what the file will say it was made from. To be called after apply.
    void apply_provenance(std::span<const ScanInput> scans);

    /// The stage named by `until`; kBuild as well where everything is to be done.
    Stage last_stage() const;
};

/// The files with their content's hash.
std::vector<ScanInput> describe_scans(std::span<const std::filesystem::path> files,
                                      const Progress& progress);

}  // namespace glowworm
