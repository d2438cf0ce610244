#pragma once

#include <filesystem>
#include <span>

#include "preprocess/command/console.h"
#include "preprocess/pipeline.h"
#include "preprocess/pipeline/work_folder.h"
#include "preprocess/report_page.h"

namespace glowworm {

/// Writes the page of a conversion whose octree is in place, and whose scans are still kept in
/// `work`. The first frame is drawn by `glowworm-view` where it lies beside this program and finds
/// a way to draw, which `console` shows; else the page says why there is none. Throws Error
/// (kCancelled) once the user has asked to stop.
void write_run_page(const std::filesystem::path& page, const std::filesystem::path& octree,
                    const Conversion& done, std::span<const ScanInput> inputs,
                    const ConvertSettings& settings, const WorkFolder& work,
                    std::span<const PhaseTime> timings, Console& console);

/// The page of a conversion that ended, for the reason `why`, since its registration cannot be
/// trusted: what there is without an octree. Nothing where `work` keeps no registration.
void write_distrust_page(const std::filesystem::path& page, const std::filesystem::path& octree,
                         const std::string& why, std::span<const ScanInput> inputs,
                         const ConvertSettings& settings, const WorkFolder& work,
                         std::span<const PhaseTime> timings);

}  // namespace glowworm
