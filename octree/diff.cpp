#include "octree/diff.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "octree/extract.h"

namespace glowworm {
namespace {

template <typename T>
void compare_section(const char* name, std::span<const T> a, std::span<const T> b,
                     OctreeDifference& out) {
    SectionDifference section{name, a.size(), b.size(), 0, 0};
    const std::size_t both = std::min(a.size(), b.size());
    if (a.size() == b.size() &&
        (both == 0 || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0)) {
        return;
    }
    for (std::size_t i = 0; i < both; ++i) {
        if (std::memcmp(&a[i], &b[i], sizeof(T)) == 0) continue;
        if (section.differing++ == 0) section.first = i;
    }
    out.sections.push_back(section);
}

std::span<const char> text(std::string_view v) {
    return {v.data(), v.size()};
}

std::string words(const Vec3f& v) {
    return std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z);
}

std::string words(const Vec3d& v) {
    return words(vec3_cast<float>(v));
}

std::string words(auto number) {
    return std::to_string(number);
}

void compare_header(const OctreeView& a, const OctreeView& b, OctreeDifference& out) {
    const auto compare = [&](const char* what, const auto& x, const auto& y) {
        if (x != y) out.header.push_back(std::string(what) + ": " + words(x) + " and " + words(y));
    };
    compare("depth", a.grid.depth, b.grid.depth);
    compare("origin", a.grid.origin, b.grid.origin);
    compare("root cube's corner", a.grid.cube_min, b.grid.cube_min);
    compare("root cube's edge", a.grid.cube_edge, b.grid.cube_edge);
    compare("lower bounds", a.bounds_min, b.bounds_min);
    compare("upper bounds", a.bounds_max, b.bounds_max);
    compare("samples", a.sample_count, b.sample_count);
    compare("dropped samples", a.dropped_count, b.dropped_count);
    compare("links per lobe", a.links_per_lobe, b.links_per_lobe);
}

double largest_of(const float (&a)[3], const float (&b)[3]) {
    double largest = 0.0;
    for (int i = 0; i < 3; ++i)
        largest = std::max(largest, std::abs(double{a[i]} - double{b[i]}));
    return largest;
}

void compare_cells(const NodeAttributes& a, const NodeAttributes& b, LevelDifference& level) {
    level.largest_opacity =
        std::max(level.largest_opacity, std::abs(double{a.opacity} - double{b.opacity}));
    level.largest_albedo = std::max(level.largest_albedo, largest_of(a.albedo, b.albedo));
    const Vec3d ndf{double{a.ndf[0]} - double{b.ndf[0]}, double{a.ndf[1]} - double{b.ndf[1]},
                    double{a.ndf[2]} - double{b.ndf[2]}};
    level.largest_ndf = std::max(level.largest_ndf, length(ndf));
}

double level_area(const OctreeView& octree, std::uint32_t level) {
    const Level at = octree.levels[level];
    double area = 0.0;
    for (const NodeAttributes& a : octree.attributes.subspan(at.first_node, at.node_count)) {
        area += a.area;
    }
    return area;
}

LevelDifference compare_level(const OctreeView& a, const OctreeView& b, std::uint32_t level) {
    LevelDifference out;
    out.level = level;
    out.area_a = level_area(a, level);
    out.area_b = level_area(b, level);
    const std::vector<std::uint64_t> cells_a = codes_of_level(a, level);
    const std::vector<std::uint64_t> cells_b = codes_of_level(b, level);
    const NodeAttributes* at_a = &a.attributes[a.levels[level].first_node];
    const NodeAttributes* at_b = &b.attributes[b.levels[level].first_node];
    std::size_t i = 0, j = 0;
    while (i < cells_a.size() && j < cells_b.size()) {
        if (cells_a[i] == cells_b[j]) {
            compare_cells(at_a[i++], at_b[j++], out);
            ++out.both;
        } else if (cells_a[i] < cells_b[j]) {
            ++i;
        } else {
            ++j;
        }
    }
    out.only_a = cells_a.size() - out.both;
    out.only_b = cells_b.size() - out.both;
    return out;
}

}  // namespace

OctreeDifference compare_octrees(const OctreeView& a, const OctreeView& b) {
    OctreeDifference out;
    compare_header(a, b, out);
    compare_section("levels", a.levels, b.levels, out);
    compare_section("nodes", a.nodes, b.nodes, out);
    compare_section("attributes", a.attributes, b.attributes, out);
    compare_section("lobes", a.lobes, b.lobes, out);
    compare_section("chunks", a.chunks, b.chunks, out);
    compare_section("points", a.surfels, b.surfels, out);
    compare_section("stations", a.stations, b.stations, out);
    compare_section("area lights", a.area_lights, b.area_lights, out);
    compare_section("names", text(a.names), text(b.names), out);
    compare_section("provenance", text(a.provenance), text(b.provenance), out);
    compare_section("links", a.links, b.links, out);

    const bool same_cube = a.grid.origin == b.grid.origin && a.grid.cube_min == b.grid.cube_min &&
                           a.grid.cube_edge == b.grid.cube_edge;
    if (same_cube) {
        for (std::uint32_t level = 0; level <= std::min(a.grid.depth, b.grid.depth); ++level) {
            out.levels.push_back(compare_level(a, b, level));
        }
    }
    return out;
}

}  // namespace glowworm
