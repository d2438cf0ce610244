#include "preprocess/command/plan.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <tbb/info.h>

#include <algorithm>
#include <utility>

#include "octree/error.h"
#include "preprocess/command/memory_limit.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/read/preflight.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kPosesBytes = 2000.0;    // a scan's entry in poses.json, with its pairs
constexpr double kCloudPointBytes = 4.0;  // of merge's PLY, on top of the scans' columns

/// What a command of some reach takes.
struct Needs {
    std::uint64_t memory = 0, output = 0, work = 0;  ///< bytes
    double processor_time = 0.0;                     ///< s
};

Needs needs_of(const Prediction& p, Reach reach) {
    const auto bytes = [](double value) { return static_cast<std::uint64_t>(value); };
    switch (reach) {
        case Reach::kRegister:
            return {p.read_memory, bytes(kPosesBytes * double(p.work.scans)), 0,
                    p.read_time + p.register_time};
        case Reach::kMerge:
            return {p.read_memory,
                    bytes((p.work.bytes_a_point + kCloudPointBytes) * p.work.octree.surfels), 0,
                    p.read_time + p.merge_time};
        case Reach::kSurface:
            return {p.surface_memory, bytes(p.work.surfel_bytes * p.work.octree.surfels), 0,
                    p.surface_time};
        case Reach::kAll:
            break;
    }
    return {p.memory(), p.output_bytes, p.work_bytes, p.processor_time()};
}

std::uint64_t at_least(std::uint64_t bytes, const Prediction& p) {
    return static_cast<std::uint64_t>(double(bytes) * (1.0 - p.work.error));
}

fs::path folder_of(const fs::path& output) {
    return output.has_parent_path() ? output.parent_path() : fs::path(".");
}

bool same_disk(const fs::path& a, const fs::path& b) {
    struct stat first = {}, second = {};
    return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 &&
           first.st_dev == second.st_dev;
}

/// Whether it may take more than --memory-limit, even if the prediction is too low by its error.
bool may_exceed(const SharedFlags& flags, const Prediction& p, const Needs& needs) {
    return flags.memory_limit > 0 &&
           double(needs.memory) > double(flags.memory_limit) * (1.0 - p.work.error);
}

/// Bytes of memory that lie in files where it takes more than --memory-limit.
std::uint64_t paged(const SharedFlags& flags, const Needs& needs) {
    return flags.memory_limit > 0 && needs.memory > flags.memory_limit ? needs.memory : 0;
}

/// The folder of what is not the result.
fs::path work_place(const SharedFlags& flags) {
    if (!flags.temp_dir.empty()) return flags.temp_dir;
    return flags.output.empty() ? fs::temp_directory_path() : folder_of(flags.output);
}

/// The folders that are written to, and how many bytes into each.
std::vector<std::pair<fs::path, std::uint64_t>> writes(const SharedFlags& flags,
                                                       const Needs& needs) {
    const fs::path output = folder_of(flags.output);
    const fs::path work = work_place(flags);
    const std::uint64_t working = needs.work + paged(flags, needs);
    if (same_disk(output, work)) return {{output, needs.output + working}};
    return {{output, needs.output}, {work, working}};
}

std::uint64_t space_left(const fs::path& folder) {
    std::error_code failed;
    const fs::space_info space = fs::space(folder, failed);
    return failed ? UINT64_MAX : space.available;
}

/// Whether the disk surely has room, even if it takes as much more as the prediction may be wrong.
bool surely_fits(const SharedFlags& flags, const Prediction& p, const Needs& needs) {
    return std::ranges::all_of(writes(flags, needs), [&](const auto& write) {
        return double(write.second) <= double(space_left(write.first)) * (1.0 - p.work.error);
    });
}

/// Throws as require_budget.
void require_room(const SharedFlags& flags, const Prediction& prediction, Reach reach) {
    const Needs needs = needs_of(prediction, reach);
    if (flags.memory_limit > 0 && flags.memory_limit < prediction.least_memory) {
        throw Error(ExitCode::kBudget,
                    fmt::format("about {} of memory are needed, of which {} cannot lie on disk, "
                                "but --memory-limit is {}; give more or use fewer scans",
                                format_bytes(needs.memory), format_bytes(prediction.least_memory),
                                format_bytes(flags.memory_limit)));
    }
    for (const auto& [folder, bytes] : writes(flags, needs)) {
        const std::uint64_t space = space_left(folder);
        if (at_least(bytes, prediction) <= space) continue;
        throw Error(ExitCode::kBudget,
                    fmt::format("'{}' has {} left but about {} are needed; free some or choose "
                                "another place with -o or --temp-dir",
                                folder.string(), format_bytes(space), format_bytes(bytes)));
    }
}

void print_plan(const Pilot& pilot, const Needs& needs, std::uint64_t on_disk, int threads,
                Reach reach) {
    fmt::print("{} of {}\n", format_number_of(pilot.points, "point"),
               format_number_of(pilot.facts.size(), "scan"));
    if (pilot.placed < pilot.facts.size() && reach != Reach::kSurface) {
        fmt::print("placed  {} of them for this prediction; what the others add is guessed\n",
                   pilot.placed);
    }
    if (reach == Reach::kAll) {
        fmt::print("depth   {}, voxels of {}, about {} leaves\n", pilot.grid.depth,
                   format_length(pilot.grid.voxel_size()),
                   format_count(static_cast<std::uint64_t>(pilot.octree.leaves)));
    }
    if (reach == Reach::kAll && pilot.least_depth != pilot.most_depth) {
        fmt::print(
            "        narrowly: it may be {} or {}, a level is four times the leaves; --depth "
            "decides it\n",
            pilot.least_depth, pilot.most_depth);
    }
    fmt::print("memory  {}\n", format_bytes(needs.memory));
    if (on_disk > 0) fmt::print("        more than --memory-limit: it will lie in files\n");
    fmt::print("disk    {} for the output, {} while it works\n", format_bytes(needs.output),
               format_bytes(needs.work));
    fmt::print("time    {:.0f} s on {}, {:.0f} s of processor time\n",
               wall_time(needs.processor_time, threads),
               format_number_of(static_cast<std::uint64_t>(threads), "thread"),
               needs.processor_time);
}

Json stages_json(const Prediction& p) {
    return {{"read", p.read_time},       {"register", p.register_time}, {"merge", p.merge_time},
            {"surface", p.surface_time}, {"build", p.build_time},       {"links", p.link_time}};
}

}  // namespace

int thread_count(const SharedFlags& flags) {
    return flags.threads > 0 ? flags.threads : tbb::info::default_concurrency();
}

void page_memory(Run& run) {
    if (run.flags.memory_limit == 0 || run.paged) return;
    run.paged = std::make_unique<PagedMemory>(work_place(run.flags), run.flags.memory_limit);
    limit_memory_beside_pages(run.flags.memory_limit, thread_count(run.flags));
}

void require_budget(Run& run, const Prediction& prediction, Reach reach) {
    require_room(run.flags, prediction, reach);
    const Needs needs = needs_of(prediction, reach);
    if (!may_exceed(run.flags, prediction, needs) || run.paged) return;
    spdlog::info("about {} of memory are needed: what exceeds --memory-limit lies in files in '{}'",
                 format_bytes(needs.memory), work_place(run.flags).string());
    page_memory(run);
}

void require_budget(Run& run, const std::vector<fs::path>& files, const ConvertSettings& settings,
                    Reach reach) {
    Workload announced = announced_work(files, settings.read);
    announced.links = settings.links;
    if (reach == Reach::kSurface) {
        // Of a merged cloud each point becomes a surfel.
        announced.octree.surfels = static_cast<double>(announced.points);
        announced.error = kPilotError;
    }
    const Prediction guess = predict(announced);
    require_budget(run, guess, reach);
    if (reach == Reach::kSurface || surely_fits(run.flags, guess, needs_of(guess, reach))) return;
    const Pilot pilot = run_pilot(files, settings, run.console.phase("look", "files"));
    run.console.end_phase();
    require_budget(run, predict(piloted_work(pilot, settings.links)), reach);
}

Json plan_work(Run& run, const std::vector<fs::path>& files, const ConvertSettings& settings,
               Reach reach) {
    page_memory(run);  // a part of all files is read
    const Progress progress = run.console.phase("look", "files");
    const Pilot pilot = reach == Reach::kSurface ? look_at_cloud(files.front(), settings.read,
                                                                 settings.surface, progress)
                                                 : run_pilot(files, settings, progress);
    run.console.end_phase();
    const std::vector<Warning> warnings = preflight(pilot.facts);
    say_warnings(warnings);

    const Prediction p = predict(piloted_work(pilot, settings.links));
    const Needs needs = needs_of(p, reach);
    const int threads = thread_count(run.flags);
    if (!run.flags.json) print_plan(pilot, needs, paged(run.flags, needs), threads, reach);
    require_room(run.flags, p, reach);
    run.last_word = "nothing was written";
    Json result = {{"dry_run", true}, {"scans", pilot.facts.size()}, {"points", pilot.points}};
    if (reach == Reach::kAll) {
        result.update({{"placed", pilot.placed},
                       {"surfels", static_cast<std::uint64_t>(pilot.octree.surfels)},
                       {"depth", pilot.grid.depth},
                       {"least_depth", pilot.least_depth},
                       {"most_depth", pilot.most_depth},
                       {"voxel_size", pilot.grid.voxel_size()},
                       {"leaves", static_cast<std::uint64_t>(pilot.octree.leaves)},
                       {"stages", stages_json(p)}});
    }
    result.update({{"memory", needs.memory},
                   {"disk", needs.output},
                   {"work_disk", needs.work},
                   {"paged_memory", paged(run.flags, needs)},
                   {"seconds", wall_time(needs.processor_time, threads)},
                   {"processor_seconds", needs.processor_time},
                   {"warnings", warnings_json(warnings)}});
    return result;
}

}  // namespace glowworm
