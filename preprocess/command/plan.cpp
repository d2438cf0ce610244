#include "preprocess/command/plan.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <tbb/info.h>

#include <algorithm>
#include <utility>

#include "octree/error.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/read/preflight.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kPosesBytes = 2000.0;    // a scan's entry in poses.json, with its pairs
constexpr double kCloudPointBytes = 4.0;  // of merge's PLY, on top of the scans' columns
constexpr double kSurfelPlyBytes = 43.0;  // a row of surface's PLY

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
            return {p.surface_memory, bytes(kSurfelPlyBytes * p.work.octree.surfels), 0,
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

/// The folders that are written to, and how many bytes into each.
std::vector<std::pair<fs::path, std::uint64_t>> writes(const SharedFlags& flags,
                                                       const Needs& needs) {
    const fs::path output = folder_of(flags.output);
    const fs::path work = flags.temp_dir.empty() ? output : flags.temp_dir;
    if (same_disk(output, work)) return {{output, needs.output + needs.work}};
    return {{output, needs.output}, {work, needs.work}};
}

std::uint64_t space_left(const fs::path& folder) {
    std::error_code failed;
    const fs::space_info space = fs::space(folder, failed);
    return failed ? UINT64_MAX : space.available;
}

/// Whether it fits even if it takes as much more as the prediction may be wrong.
bool surely_fits(const SharedFlags& flags, const Prediction& p, const Needs& needs) {
    const auto at_most = [&](std::uint64_t bytes) { return double(bytes) / (1.0 - p.work.error); };
    if (flags.memory_limit > 0 && at_most(needs.memory) > double(flags.memory_limit)) return false;
    return std::ranges::all_of(writes(flags, needs), [&](const auto& write) {
        return at_most(write.second) <= double(space_left(write.first));
    });
}

void print_plan(const Pilot& pilot, const Needs& needs, int threads, Reach reach) {
    fmt::print("{} of {}\n", format_number_of(pilot.points, "point"),
               format_number_of(pilot.facts.size(), "scan"));
    if (pilot.placed < pilot.facts.size() && reach != Reach::kSurface) {
        fmt::print("placed  {} of them for this prediction; what the others add is guessed\n",
                   pilot.placed);
    }
    if (reach == Reach::kAll) {
        fmt::print("depth   {}, voxels of {:.2f} cm, about {} leaves\n", pilot.grid.depth,
                   100.0 * pilot.grid.voxel_size(),
                   format_count(static_cast<std::uint64_t>(pilot.octree.leaves)));
    }
    if (reach == Reach::kAll && pilot.least_depth != pilot.most_depth) {
        fmt::print(
            "        narrowly: it may be {} or {}, a level is four times the leaves; --depth "
            "decides it\n",
            pilot.least_depth, pilot.most_depth);
    }
    fmt::print("memory  {}\n", format_bytes(needs.memory));
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

void require_budget(const SharedFlags& flags, const Prediction& prediction, Reach reach) {
    const Needs needs = needs_of(prediction, reach);
    if (flags.memory_limit > 0 && at_least(needs.memory, prediction) > flags.memory_limit) {
        throw Error(
            ExitCode::kBudget,
            fmt::format("about {} of memory are needed but --memory-limit is {}; give more, "
                        "use fewer scans or larger voxels",
                        format_bytes(needs.memory), format_bytes(flags.memory_limit)));
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
    require_budget(run.flags, guess, reach);
    if (reach == Reach::kSurface || surely_fits(run.flags, guess, needs_of(guess, reach))) return;
    const Pilot pilot = run_pilot(files, settings, run.console.phase("look", "files"));
    run.console.end_phase();
    require_budget(run.flags, predict(piloted_work(pilot, settings.links)), reach);
}

Json plan_work(Run& run, const std::vector<fs::path>& files, const ConvertSettings& settings,
               Reach reach) {
    const Progress progress = run.console.phase("look", "files");
    const Pilot pilot = reach == Reach::kSurface ? look_only(files, settings.read, progress)
                                                 : run_pilot(files, settings, progress);
    run.console.end_phase();
    const std::vector<Warning> warnings = preflight(pilot.facts);
    say_warnings(warnings);

    const Prediction p = predict(piloted_work(pilot, settings.links));
    const Needs needs = needs_of(p, reach);
    const int threads = thread_count(run.flags);
    if (!run.flags.json) print_plan(pilot, needs, threads, reach);
    require_budget(run.flags, p, reach);
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
                   {"seconds", wall_time(needs.processor_time, threads)},
                   {"processor_seconds", needs.processor_time},
                   {"warnings", warnings_json(warnings)}});
    return result;
}

}  // namespace glowworm
