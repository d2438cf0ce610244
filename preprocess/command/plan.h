#pragma once

#include <filesystem>
#include <vector>

#include "preprocess/command/command.h"
#include "preprocess/pipeline.h"
#include "preprocess/pipeline/prediction.h"

namespace glowworm {

/// How far a command goes: what of a Prediction concerns it.
enum class Reach { kRegister, kMerge, kSurface, kAll };

/// From here on large blocks and mapped octrees are held to --memory-limit (paged_memory.h), where
/// there is one: for commands that read octrees, which take as much as those are large.
void page_memory(Run& run);

/// Refuses at once what cannot fit: throws Error (kBudget), with the size that is needed, where
/// --memory-limit leaves no room to work in, or the folders of output and temporary files have too
/// little space, even if the prediction is too high by its own error. From here on work that may
/// take more than --memory-limit keeps its large blocks in files (paged_memory.h).
void require_budget(Run& run, const Prediction& prediction, Reach reach);

/// The same for scans: by their headers, and where these leave it open by a pilot.
void require_budget(Run& run, const std::vector<std::filesystem::path>& files,
                    const ConvertSettings& settings, Reach reach);

/// --dry-run: looks at all points and does a small part of the work; says depth, memory, disk and
/// time and every warning, writes nothing. Throws as require_budget.
nlohmann::ordered_json plan_work(Run& run, const std::vector<std::filesystem::path>& files,
                                 const ConvertSettings& settings, Reach reach);

/// As many threads as the work will have.
int thread_count(const SharedFlags& flags);

}  // namespace glowworm
