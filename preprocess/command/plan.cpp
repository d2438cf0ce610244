#include "preprocess/command/plan.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "octree/error.h"
#include "preprocess/read/describe.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;

// Scans without poses: how much farther each one reaches than those before it.
constexpr double kReachPerScan = 0.02;

std::uint64_t memory_of(const Prediction& p, Reach reach) {
    switch (reach) {
        case Reach::kMerge:
            return p.read_memory;
        case Reach::kSurface:
            return p.surface_memory;
        case Reach::kBuild:
            return p.build_memory;
        case Reach::kAll:
            return p.memory();
    }
    return p.memory();
}

fs::path folder_of(const fs::path& output) {
    return output.has_parent_path() ? output.parent_path() : fs::path(".");
}

void require_space(const fs::path& folder, std::uint64_t needed) {
    std::error_code failed;
    const fs::space_info space = fs::space(folder, failed);
    if (failed || space.available >= needed) return;
    throw Error(ExitCode::kBudget,
                fmt::format("'{}' has {} left but {} are needed; free some or choose another place "
                            "with -o or --temp-dir",
                            folder.string(), format_bytes(space.available), format_bytes(needed)));
}

bool same_disk(const fs::path& a, const fs::path& b) {
    struct stat first = {}, second = {};
    return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 &&
           first.st_dev == second.st_dev;
}

/// Longest side of the box round all scans: where their poses put them, else what one of them spans
/// in the mean and some more for each other.
double extent_of(std::span<const ScanDescription> scans) {
    constexpr double kFar = std::numeric_limits<double>::infinity();
    Eigen::AlignedBox3d box;
    double sides = 0.0;
    bool all_posed = true;
    for (const ScanDescription& scan : scans) {
        const Vec3d low = scan.facts.low, high = scan.facts.high;
        const Vec3d size = high - low;
        sides += std::max({size.x, size.y, size.z});
        all_posed = all_posed && scan.header.T_world_scan.has_value();
        for (int corner = 0; corner < 8 && all_posed; ++corner) {
            box.extend(*scan.header.T_world_scan * Eigen::Vector3d(corner & 1 ? high.x : low.x,
                                                                   corner & 2 ? high.y : low.y,
                                                                   corner & 4 ? high.z : low.z));
        }
    }
    const double posed = all_posed && !box.isEmpty() ? box.sizes().maxCoeff() : kFar;
    if (posed < kFar) return posed;
    const auto count = static_cast<double>(scans.size());
    return sides / count * (1.0 + kReachPerScan * (count - 1.0));
}

/// Median over the scans of their points' distances to the nearest one.
double spacing_of(std::span<const ScanDescription> scans) {
    std::vector<double> spacings;
    for (const ScanDescription& scan : scans) {
        if (scan.facts.spacing > 0.0) spacings.push_back(scan.facts.spacing);
    }
    if (spacings.empty()) return 0.0;
    const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
    std::nth_element(spacings.begin(), middle, spacings.end());
    return *middle;
}

}  // namespace

int thread_count(const SharedFlags& flags) {
    return flags.threads > 0 ? flags.threads : tbb::info::default_concurrency();
}

void require_budget(const SharedFlags& flags, const Prediction& prediction, Reach reach) {
    const std::uint64_t memory = memory_of(prediction, reach);
    if (flags.memory_limit > 0 && memory > flags.memory_limit) {
        throw Error(
            ExitCode::kBudget,
            fmt::format("about {} of memory are needed but --memory-limit is {}; give more, "
                        "use fewer scans or larger voxels",
                        format_bytes(memory), format_bytes(flags.memory_limit)));
    }
    const fs::path output = folder_of(flags.output);
    const bool keeps = reach == Reach::kAll;
    const fs::path work = flags.temp_dir.empty() ? output : flags.temp_dir;
    const std::uint64_t work_bytes = keeps ? prediction.work_bytes : 0;
    if (same_disk(output, work)) {
        require_space(output, prediction.output_bytes + work_bytes);
    } else {
        require_space(output, prediction.output_bytes);
        require_space(work, work_bytes);
    }
}

nlohmann::ordered_json plan_work(Run& run, const std::vector<fs::path>& files,
                                 const ReadSettings& read, const BuildFlags& build, Reach reach) {
    const Progress progress = run.console.phase("look", "files");
    std::vector<ScanDescription> scans;
    std::vector<ScanFacts> facts;
    std::uint64_t points = 0;
    for (std::size_t i = 0; i < files.size(); ++i) {
        progress(i, files.size());
        const ScanFileDescription file = describe_scan_file(files[i], read);
        points += file.points;
        for (const ScanDescription& scan : file.scans) {
            scans.push_back(scan);
            facts.push_back(scan.facts);
        }
    }
    run.console.end_phase();
    const std::vector<Warning> warnings = preflight(facts);
    say_warnings(warnings);

    Workload work{.scans = std::max<std::size_t>(1, scans.size()), .points = points};
    for (const ScanFacts& scan : facts)
    work.spacing = spacing_of(scans);
    work.extent = scans.empty() ? 0.0 : extent_of(scans);
    work.depth = build.depth;
    work.voxel_size = build.voxel_size;
    work.links = build.links;
    const Prediction p = predict(work, thread_count(run.flags));
    const std::uint64_t memory = memory_of(p, reach);
    if (!run.flags.json) {
        fmt::print("{} of {}\n", format_number_of(points, "point"),
                   format_number_of(scans.size(), "scan"));
        fmt::print("depth   {}, voxels of {:.2f} cm, about {} leaves\n", p.depth,
                   100.0 * p.voxel_size, format_count(p.leaves));
        fmt::print("memory  {}\n", format_bytes(memory));
        fmt::print("disk    {} for the output, {} while it works\n", format_bytes(p.output_bytes),
                   format_bytes(reach == Reach::kAll ? p.work_bytes : 0));
        fmt::print("time    {:.0f} s on {} threads\n", p.seconds, thread_count(run.flags));
    }
    require_budget(run.flags, p, reach);
    run.last_word = "nothing was written";
    return {{"dry_run", true},
            {"scans", scans.size()},
            {"points", points},
            {"depth", p.depth},
            {"voxel_size", p.voxel_size},
            {"leaves", p.leaves},
            {"memory", memory},
            {"disk", p.output_bytes},
            {"work_disk", reach == Reach::kAll ? p.work_bytes : 0},
            {"seconds", p.seconds},
            {"warnings", warnings_json(warnings)}};
}

}  // namespace glowworm
