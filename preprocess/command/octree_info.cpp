#include "preprocess/command/octree_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "octree/node_layout.h"
#include "octree/statistics.h"
#include "preprocess/command/command.h"
#include "preprocess/command/grid_file.h"
#include "preprocess/command/level_plot.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kBarWidth = 40;

Json vector_json(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

Json bounds_json(const OctreeStatistics& s) {
    const Vec3d low = s.grid.origin + vec3_cast<double>(s.bounds_min);
    const Vec3d high = s.grid.origin + vec3_cast<double>(s.bounds_max);
    return {{"min", vector_json(low)}, {"max", vector_json(high)}};
}

Json histogram_json(const Histogram& histogram) {
    return {{"edges", histogram.edges}, {"counts", histogram.counts}};
}

Json levels_json(const OctreeStatistics& s) {
    Json levels = Json::array();
    for (const LevelStatistics& level : s.levels) {
        levels.push_back({{"level", level.level},
                          {"nodes", level.nodes},
                          {"occupied_fraction", level.occupied_fraction},
                          {"mean_children", level.mean_children},
                          {"mean_opacity", level.mean_opacity},
                          {"mean_ndf_length", level.mean_ndf_length},
                          {"bytes", level.bytes}});
    }
    return levels;
}

Json to_json(const OctreeStatistics& s) {
    return {{"format_version", s.format_version},
            {"depth", s.grid.depth},
            {"voxel_size", s.grid.voxel_size()},
            {"grid", grid_json(s.grid)},
            {"origin", vector_json(s.grid.origin)},
            {"bounds", bounds_json(s)},
            {"samples", s.samples},
            {"dropped", s.dropped},
            {"leaves", s.leaves},
            {"nodes", s.nodes},
            {"lobes", s.lobes},
            {"chunks", s.chunks},
            {"bytes", s.bytes},
            {"bytes_per_leaf", s.bytes_per_leaf},
            {"area", s.total_area},
            {"spacing", s.mean_spacing},
            {"levels", levels_json(s)},
            {"histograms",
             {{"samples_per_leaf", histogram_json(s.samples_per_leaf)},
              {"ndf_length", histogram_json(s.ndf_length)},
              {"opacity", histogram_json(s.opacity)}}},
            {"area_lights", s.area_lights},
            {"scans", s.scans},
            {"provenance", Json::parse(s.provenance, nullptr, false)}};
}

void print_histogram(const std::string& title, const Histogram& histogram) {
    std::uint64_t most = 1;
    for (const std::uint64_t count : histogram.counts)
        most = std::max(most, count);
    fmt::print("\n{}\n", title);
    for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
        if (histogram.counts[i] == 0) continue;
        const std::size_t filled = (histogram.counts[i] * kBarWidth + most - 1) / most;
        fmt::print("{:>8.4g} – {:<8.4g} {:<{}} {:>12}\n", histogram.edges[i],
                   histogram.edges[i + 1], std::string(filled, '#'), kBarWidth,
                   format_count(histogram.counts[i]));
    }
}

void print(const OctreeStatistics& s, const std::filesystem::path& path) {
    const Vec3d size = vec3_cast<double>(s.bounds_max - s.bounds_min);
    fmt::print("{}: glowworm octree, format {}\n", path.string(), s.format_version);
    fmt::print("samples     {} ({} dropped)\n", format_count(s.samples), format_count(s.dropped));
    fmt::print("extent      {:.2f} x {:.2f} x {:.2f} m, surface {:.1f} m2, spacing {:.1f} mm\n",
               size.x, size.y, size.z, s.total_area, s.mean_spacing * 1e3);
    const Vec3d low = s.grid.origin + vec3_cast<double>(s.bounds_min);
    const Vec3d high = s.grid.origin + vec3_cast<double>(s.bounds_max);
    fmt::print("bounds      {:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f} m\n", low.x, low.y, low.z,
               high.x, high.y, high.z);
    fmt::print("origin      {:.3f} {:.3f} {:.3f} m\n", s.grid.origin.x, s.grid.origin.y,
               s.grid.origin.z);
    fmt::print("leaves      {} at depth {}, {:.2f} cm, {} lobes\n", format_count(s.leaves),
               s.grid.depth, s.grid.voxel_size() * 100.0f, format_count(s.lobes));
    fmt::print("file        {}, {:.0f} bytes a leaf, {:.1f} a sample\n", format_bytes(s.bytes),
               s.bytes_per_leaf, s.samples > 0 ? double(s.bytes) / double(s.samples) : 0.0);
    fmt::print("scans       {}\n", s.scans.size());
    for (const std::string& scan : s.scans)
        fmt::print("            {}\n", scan);
    fmt::print("area lights {}\n", s.area_lights.size());
    for (const std::string& light : s.area_lights)
        fmt::print("            {}\n", light);

    fmt::print("\n{:>5} {:>12} {:>10} {:>9} {:>8} {:>8} {:>12}\n", "level", "nodes", "occupied",
               "children", "opacity", "ndf", "bytes");
    for (const LevelStatistics& level : s.levels) {
        fmt::print("{:>5} {:>12} {:>9.3g}% {:>9.2f} {:>8.3f} {:>8.3f} {:>12}\n", level.level,
                   format_count(level.nodes), level.occupied_fraction * 100.0, level.mean_children,
                   level.mean_opacity, level.mean_ndf_length, format_count(level.bytes));
    }
    print_histogram("samples per leaf", s.samples_per_leaf);
    print_histogram("NDF length of leaves", s.ndf_length);
    print_histogram("opacity of leaves", s.opacity);
}

}  // namespace

bool is_octree_file(const std::filesystem::path& path) {
    char start[sizeof(kMagic)] = {};
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;
    std::ifstream(path, std::ios::binary).read(start, sizeof(start));
    return std::memcmp(start, kMagic, sizeof(kMagic)) == 0;
}

Json octree_info(const std::filesystem::path& path, bool json, const std::filesystem::path& plot) {
    const OctreeFile file = OctreeFile::open(path);
    const OctreeStatistics statistics = measure_octree(file.view(), file.bytes());
    if (!plot.empty()) write_png(plot_levels(measure_levels(file.view())), plot);
    file.require_intact();
    if (!json) print(statistics, path);
    return to_json(statistics);
}

}  // namespace glowworm
