#include "octree/statistics.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "octree/tables.h"

namespace glowworm {
namespace {

constexpr std::size_t kGrain = 16384;
constexpr std::size_t kUnitBins = 20;
constexpr std::size_t kSampleBins = 24;

/// Sums over nodes; whole numbers and fixed grain, so the result is the same on any number of
/// threads (deterministic reduction).
struct Sums {
    std::uint64_t children = 0;
    double opacity = 0.0, ndf_length = 0.0;
    double area = 0.0, spacing = 0.0;
    std::array<std::uint64_t, kUnitBins> opacity_bins{}, ndf_bins{};
    std::array<std::uint64_t, kSampleBins> sample_bins{};

    void operator+=(const Sums& other) {
        children += other.children;
        opacity += other.opacity;
        ndf_length += other.ndf_length;
        area += other.area;
        spacing += other.spacing;
        for (std::size_t i = 0; i < kUnitBins; ++i) {
            opacity_bins[i] += other.opacity_bins[i];
            ndf_bins[i] += other.ndf_bins[i];
        }
        for (std::size_t i = 0; i < kSampleBins; ++i)
            sample_bins[i] += other.sample_bins[i];
    }
};

std::size_t unit_bin(float value) {
    const float bin = value * static_cast<float>(kUnitBins);
    return bin > 0.0f ? std::min(kUnitBins - 1, static_cast<std::size_t>(std::min(bin, 1e6f))) : 0;
}

/// 0: below 1 sample, 1: 1 to 2, 2: 2 to 4, ...
std::size_t sample_bin(double samples) {
    const auto whole = static_cast<std::uint64_t>(std::clamp(samples + 1e-4, 0.0, 1e15));
    return std::min<std::size_t>(kSampleBins - 1, static_cast<std::size_t>(std::bit_width(whole)));
}

void add_leaf(const OctreeView& octree, std::uint32_t node, Sums& sums) {
    const Node leaf = octree.nodes[node];
    double samples = 0.0;
    const std::uint64_t end = std::min<std::uint64_t>(
        octree.lobes.size(), std::uint64_t{leaf.first} + (leaf.mask >> 8 & 3));
    for (std::uint64_t l = leaf.first; l < end; ++l) {
        const Lobe& lobe = octree.lobes[l];
        sums.area += lobe.area;
        sums.spacing += static_cast<double>(lobe.area) * lobe.spacing;
        if (lobe.spacing > 0.0f) {
            samples += static_cast<double>(lobe.area) / lobe.spacing / lobe.spacing;
        }
    }
    ++sums.sample_bins[sample_bin(samples)];
}

Sums sum_level(const OctreeView& octree, std::uint32_t level) {
    const Level at = octree.levels[level];
    const bool leaves = level == octree.grid.depth;
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::uint32_t>(at.first_node, at.first_node + at.node_count, kGrain),
        Sums{},
        [&](const auto& range, Sums sums) {
            for (std::uint32_t i = range.begin(); i != range.end(); ++i) {
                const NodeAttributes& a = octree.attributes[i];
                const float ndf =
                    std::sqrt(a.ndf[0] * a.ndf[0] + a.ndf[1] * a.ndf[1] + a.ndf[2] * a.ndf[2]);
                sums.opacity += a.opacity;
                sums.ndf_length += ndf;
                sums.children +=
                    static_cast<std::uint64_t>(std::popcount(octree.nodes[i].mask & 0xff));
                if (!leaves) continue;
                ++sums.opacity_bins[unit_bin(a.opacity)];
                ++sums.ndf_bins[unit_bin(ndf)];
                add_leaf(octree, i, sums);
            }
            return sums;
        },
        [](Sums a, const Sums& b) {
            a += b;
            return a;
        });
}

template <std::size_t n>
Histogram unit_histogram(const std::array<std::uint64_t, n>& counts) {
    Histogram histogram;
    for (std::size_t i = 0; i <= n; ++i) {
        histogram.edges.push_back(static_cast<double>(i) / static_cast<double>(n));
    }
    histogram.counts.assign(counts.begin(), counts.end());
    return histogram;
}

/// Without the empty bins at the end.
Histogram sample_histogram(const std::array<std::uint64_t, kSampleBins>& counts) {
    std::size_t used = kSampleBins;
    while (used > 1 && counts[used - 1] == 0)
        --used;
    Histogram histogram;
    histogram.edges.push_back(0.0);
    for (std::size_t i = 0; i < used; ++i) {
        histogram.edges.push_back(static_cast<double>(std::uint64_t{1} << i));
    }
    histogram.counts.assign(counts.begin(), counts.begin() + static_cast<std::ptrdiff_t>(used));
    return histogram;
}

}  // namespace

OctreeStatistics measure_octree(const OctreeView& octree, std::uint64_t file_bytes) {
    OctreeStatistics out;
    out.format_version = kFormatVersion;
    out.grid = octree.grid;
    out.bounds_min = octree.bounds_min;
    out.bounds_max = octree.bounds_max;
    out.samples = octree.sample_count;
    out.dropped = octree.dropped_count;
    out.nodes = octree.nodes.size();
    out.lobes = octree.lobes.size();
    out.chunks = octree.chunks.size();
    out.leaves = octree.levels.empty() ? 0 : octree.levels.back().node_count;
    out.bytes = file_bytes;
    out.bytes_per_leaf =
        out.leaves > 0 ? static_cast<double>(file_bytes) / static_cast<double>(out.leaves) : 0.0;
    out.provenance = octree.provenance;
    for (const Station& station : read_stations(octree))
        out.scans.push_back(station.name);
    for (const AreaLight& light : read_area_lights(octree))
        out.area_lights.push_back(light.name);

    for (std::uint32_t level = 0; level < octree.levels.size(); ++level) {
        const Sums sums = sum_level(octree, level);
        const auto nodes = static_cast<double>(octree.levels[level].node_count);
        LevelStatistics s;
        s.level = level;
        s.nodes = octree.levels[level].node_count;
        s.occupied_fraction = std::ldexp(nodes, -3 * static_cast<int>(level));
        s.mean_children = static_cast<double>(sums.children) / nodes;
        s.mean_opacity = sums.opacity / nodes;
        s.mean_ndf_length = sums.ndf_length / nodes;
        s.bytes = s.nodes * (sizeof(Node) + sizeof(NodeAttributes));
        if (level + 1 == octree.levels.size()) {
            s.bytes += octree.lobes.size_bytes();
            out.samples_per_leaf = sample_histogram(sums.sample_bins);
            out.ndf_length = unit_histogram(sums.ndf_bins);
            out.opacity = unit_histogram(sums.opacity_bins);
            out.total_area = sums.area;
            out.mean_spacing = sums.area > 0.0 ? sums.spacing / sums.area : 0.0;
        }
        out.levels.push_back(s);
    }
    return out;
}

}  // namespace glowworm
