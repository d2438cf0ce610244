#include "preprocess/command/convert_report.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <iterator>

#include "octree/atomic_file.h"
#include "octree/statistics.h"
#include "preprocess/command/command.h"
#include "preprocess/command/first_frame.h"
#include "preprocess/pipeline/checkpoint.h"
#include "preprocess/register/plan_view.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;

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

/// "1 234, 0.3 %" of the surfels.
std::string share_of(std::size_t count, const Conversion& done) {
    const auto all = static_cast<double>(std::max<std::size_t>(done.surface.surfels, 1));
    return fmt::format("{}, {:.1f} %", format_count(count),
                       100.0 * static_cast<double>(count) / all);
}

Rows read_rows(const Conversion& done) {
    const std::size_t scans = done.registration.poses.scans.size();
    return {
        {"scans placed", fmt::format("{} of {}", scans - done.registration.unregistered, scans)},
        {"points read", format_count(done.points)},
        {"outliers removed", format_count(done.outliers)}};
}

Rows fact_rows(const Conversion& done, const OctreeStatistics& s) {
    const Vec3d size = vec3_cast<double>(s.bounds_max - s.bounds_min);
    Rows rows = read_rows(done);
    const Rows more = {
        {"moving things removed", format_count(done.merge.moving)},
        {"surfels", format_count(s.samples)},
        {"extent", fmt::format("{:.1f} × {:.1f} × {:.1f} m", size.x, size.y, size.z)},
        {"surface", fmt::format("{:.1f} m²", s.total_area)},
        {"leaves", fmt::format("{} of {}, depth {}", format_count(s.leaves),
                               format_length(s.grid.voxel_size()), s.grid.depth)},
        {"file", format_bytes(s.bytes)},
        {"point spacing, range noise",
         fmt::format("{}, {}", format_length(done.surface.median_spacing),
                     format_length(done.surface.range_noise))},
        {"normals turned by", describe(done.surface.orientation)},
        {"normals whose side nothing decided", share_of(done.surface.unsure_side, done)},
        {"normals that may be off by 11° and more", share_of(done.surface.weak, done)},
        {"albedo from", describe(done.surface.albedo)}};
    rows.insert(rows.end(), more.begin(), more.end());
    return rows;
}

/// "glowworm 0.1.0, 2026-11-22 23:52 UTC, of 6 files, 9.6 MB"
std::string say_made(std::span<const ScanInput> inputs) {
    std::uint64_t bytes = 0;
    for (const ScanInput& input : inputs)
        bytes += input.content.bytes;
    return fmt::format("glowworm {}, {:%Y-%m-%d %H:%M} UTC, of {}, {}", GLOWWORM_VERSION,
                       fmt::gmtime(std::time(nullptr)), format_number_of(inputs.size(), "file"),
                       format_bytes(bytes));
}

/// What there is to say with and without an octree.
RunPage page_of(const fs::path& octree, const Conversion& done, std::span<const ScanInput> inputs,
                const ConvertSettings& settings, const WorkFolder& work,
                std::span<const PhaseTime> timings) {
    RunPage content;
    content.title = octree.filename().string();
    content.made = say_made(inputs);
    content.doubt = distrust(done.registration);
    content.warnings = done.warnings;
    content.trust = trust_table(done.registration);
    content.timings.assign(timings.begin(), timings.end());
    content.plan_png = draw_plan(done, inputs, settings, work);
    return content;
}

void write_page(const fs::path& page, const RunPage& content) {
    AtomicFile html(page);
    html.write(format_page(content));
    html.commit();
}

}  // namespace

void write_run_page(const fs::path& page, const fs::path& octree, const Conversion& done,
                    std::span<const ScanInput> inputs, const ConvertSettings& settings,
                    const WorkFolder& work, std::span<const PhaseTime> timings, Console& console) {
    const OctreeFile file = OctreeFile::open(octree);
    const OctreeStatistics statistics = measure_octree(file.view(), file.bytes());
    RunPage content = page_of(octree, done, inputs, settings, work, timings);
    content.facts = fact_rows(done, statistics);
    content.levels = level_rows(statistics);
    FirstFrame frame = draw_first_frame(octree, work.part("frame").string() + ".png", console);
    content.frame_png = std::move(frame.png);
    content.no_frame = std::move(frame.why_not);
    write_page(page, content);
}

void write_distrust_page(const fs::path& page, const fs::path& octree, const std::string& why,
                         std::span<const ScanInput> inputs, const ConvertSettings& settings,
                         const WorkFolder& work, std::span<const PhaseTime> timings) {
    Conversion done;
    if (!load_registration(work, done)) return;
    RunPage content = page_of(octree, done, inputs, settings, work, timings);
    content.facts = read_rows(done);
    content.no_frame = "There is no octree: " + why + ".";
    write_page(page, content);
}

}  // namespace glowworm
