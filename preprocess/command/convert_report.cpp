#include "preprocess/command/convert_report.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <thread>

#include "octree/atomic_file.h"
#include "octree/statistics.h"
#include "preprocess/command/command.h"
#include "preprocess/pipeline/checkpoint.h"
#include "preprocess/register/plan_view.h"

extern char** environ;

namespace glowworm {
namespace {

namespace fs = std::filesystem;

constexpr auto kLongestDrawing = std::chrono::minutes(5);

std::string content_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// The scans from above, as a PNG; empty where none of them is kept.
std::string draw_plan(const Conversion& done, std::span<const ScanInput> inputs,
                      const ConvertSettings& settings, const WorkFolder& work) {
    std::vector<Scan> scans;
    for (const ScanInput& input : inputs) {
        Ingested kept;
        if (!load_ingested(work, ingest_key(input, settings), input.path, kept)) continue;
        std::ranges::move(kept.scans, std::back_inserter(scans));
    }
    if (scans.empty()) return {};
    const fs::path file = work.part("plan");
    write_plan_view(scans, done.registration.poses, file);
    return content_of(file);
}

/// Runs a program with nothing to say and waits for it; whether it ended well and in time.
bool run_silently(std::vector<std::string> words) {
    std::vector<char*> argv;
    for (std::string& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int stream : {0, 1, 2})
        posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
    pid_t child = 0;
    const int failed =
        ::posix_spawn(&child, words[0].c_str(), &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) return false;
    const auto latest = std::chrono::steady_clock::now() + kLongestDrawing;
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
        if (std::chrono::steady_clock::now() > latest) ::kill(child, SIGKILL);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::string draw_frame(const fs::path& octree, const WorkFolder& work, std::string& why_not) {
    std::error_code failed;
    const fs::path viewer =
        fs::read_symlink("/proc/self/exe", failed).replace_filename("glowworm-view");
    if (!fs::exists(viewer, failed)) {
        why_not = "glowworm-view is not beside glowworm, so there is no frame.";
        return {};
    }
    const fs::path file = work.part("frame").string() + ".png";
    const bool drawn =
        run_silently({viewer.string(), "--headless", "--size", "960x540", "--bounces", "4",
                      "--force", "-o", file.string(), "--", octree.string()});
    const std::string png = drawn ? content_of(file) : std::string();
    fs::remove(file, failed);
    if (png.empty()) {
        why_not = fmt::format("glowworm-view could not draw here; try `glowworm-view {}`.",
                              octree.string());
    }
    return png;
}

Rows level_rows(const OctreeStatistics& s) {
    Rows rows = {{"level", "nodes", "occupied", "children", "opacity", "NDF length", "bytes"}};
    for (const LevelStatistics& level : s.levels) {
        rows.push_back({fmt::format("{}", level.level), format_count(level.nodes),
                        fmt::format("{:.3g} %", 100.0 * level.occupied_fraction),
                        fmt::format("{:.2f}", level.mean_children),
                        fmt::format("{:.3f}", level.mean_opacity),
                        fmt::format("{:.3f}", level.mean_ndf_length), format_bytes(level.bytes)});
    }
    return rows;
}

Rows fact_rows(const Conversion& done, const OctreeStatistics& s) {
    const Vec3d size = vec3_cast<double>(s.bounds_max - s.bounds_min);
    const std::size_t scans = done.registration.poses.scans.size();
    return {
        {"scans placed", fmt::format("{} of {}", scans - done.registration.unregistered, scans)},
        {"points read", format_count(done.points)},
        {"outliers removed", format_count(done.outliers)},
        {"moving things removed", format_count(done.merge.moving)},
        {"surfels", format_count(s.samples)},
        {"extent", fmt::format("{:.1f} × {:.1f} × {:.1f} m", size.x, size.y, size.z)},
        {"surface", fmt::format("{:.1f} m²", s.total_area)},
        {"leaves", fmt::format("{} of {:.2f} cm, depth {}", format_count(s.leaves),
                               100.0 * s.grid.voxel_size(), s.grid.depth)},
        {"file", format_bytes(s.bytes)}};
}

}  // namespace

void write_run_page(const fs::path& page, const fs::path& octree, const Conversion& done,
                    std::span<const ScanInput> inputs, const ConvertSettings& settings,
                    const WorkFolder& work, std::span<const PhaseTime> timings) {
    const OctreeFile file = OctreeFile::open(octree);
    const OctreeStatistics statistics = measure_octree(file.view(), file.bytes());
    RunPage content;
    content.title = octree.filename().string();
    content.facts = fact_rows(done, statistics);
    content.warnings = done.warnings;
    content.trust = trust_table(done.registration);
    content.levels = level_rows(statistics);
    content.timings.assign(timings.begin(), timings.end());
    content.plan_png = draw_plan(done, inputs, settings, work);
    content.frame_png = draw_frame(octree, work, content.no_frame);
    AtomicFile html(page);
    html.write(format_page(content));
    html.commit();
}

}  // namespace glowworm
