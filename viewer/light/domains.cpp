#include "viewer/light/domains.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "octree/extract.h"
#include "octree/morton.h"

namespace glowworm {
namespace {

constexpr float kSameSide = 0.5f;    // cosine of 60 degrees, as where lobes are told apart
constexpr std::size_t kClasses = 7;  // axes a lobe may face along, and what emits

struct FacingOneWay {
    std::uint32_t which = 0;
    float area = 0.0f;
    Vec3f ndf;
};

float area_of(const Lobe& lobe) {
    return std::isfinite(lobe.area) ? std::max(lobe.area, 1e-12f) : 1e-12f;
}

std::size_t class_of(const Lobe& lobe) {
    if (lobe.light != 0 || lobe.emission != 0) return kClasses - 1;
    const Vec3f n = to_vec3(lobe.ndf);
    const float x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    if (x >= y && x >= z) return n.x < 0.0f ? 1 : 0;
    if (y >= z) return n.y < 0.0f ? 3 : 2;
    return n.z < 0.0f ? 5 : 4;
}

/// Which of a cell's groups each of its lobes belongs to, and how many there are: lobes by the axis
/// they face along, joined where their mean normals lie within 60 degrees, the larger first.
std::uint32_t group_cell(std::span<const Lobe> lobes, std::span<std::uint8_t> group_of) {
    std::array<FacingOneWay, kClasses> classes;
    for (std::uint32_t c = 0; c < kClasses; ++c)
        classes[c].which = c;
    for (const Lobe& lobe : lobes) {
        FacingOneWay& of = classes[class_of(lobe)];
        of.area += area_of(lobe);
        of.ndf += to_vec3(lobe.ndf) * area_of(lobe);
    }
    std::ranges::stable_sort(classes, std::ranges::greater{}, &FacingOneWay::area);
    std::array<Vec3f, kClasses> ndf;
    std::array<bool, kClasses> emits{};
    std::array<std::uint8_t, kClasses> group{};
    std::uint32_t count = 0;
    for (const FacingOneWay& of : classes) {
        if (of.area <= 0.0f) break;
        std::uint32_t g = 0;
        const bool of_lamp = of.which == kClasses - 1;
        while (g < count &&
               (emits[g] || of_lamp || dot(normalized(ndf[g]), normalized(of.ndf)) <= kSameSide))
            ++g;
        if (g == count) {
            ndf[count] = {};
            emits[count++] = of_lamp;
        }
        ndf[g] += of.ndf;
        group[of.which] = static_cast<std::uint8_t>(g);
    }
    for (std::size_t i = 0; i < lobes.size() && !group_of.empty(); ++i)
        group_of[i] = group[class_of(lobes[i])];
    return count;
}

}  // namespace

std::uint32_t LightGroups::lobe_of(std::uint32_t group, std::uint32_t ray) const {
    const std::uint32_t first = starts[group], last = starts[group + 1];
    if (last - first == 1) return members[first];
    constexpr std::uint32_t kGolden = 2654435769u;  // its multiples spread evenly, at every length
    const float at = static_cast<float>(((ray + 1) * kGolden) >> 8) * (1.0f / 16777216.0f);
    const auto begin = share.begin() + first, end = share.begin() + last;
    const auto found = std::upper_bound(begin, end - 1, at);
    return members[static_cast<std::size_t>(found - share.begin())];
}

LightDomains::LightDomains(const OctreeView& octree) : octree_(octree) {
    if (octree.lobes.empty()) return;
    const std::uint32_t depth = octree.grid.depth;
    most_coarser_ = std::min(kMostCoarser, depth);
    level_ = depth - most_coarser_;
    const Level domains = octree.levels[level_];
    edges_.resize(most_coarser_ + 1);
    for (std::uint32_t c = 0; c <= most_coarser_; ++c) {
        for (std::uint32_t d = 0; d < domains.node_count; ++d) {
            std::uint32_t node = domains.first_node + d;
            for (std::uint32_t level = level_; level < depth - c; ++level)
                node = octree.nodes[node].first;
            edges_[c].push_back(node);
        }
        const Level last = octree.levels[depth - c];
        edges_[c].push_back(last.first_node + last.node_count);
    }
    for (const std::uint32_t node : edges_[0])
        lobes_.push_back(first_lobe(depth, node));
    codes_ = codes_of_level(octree, level_);
    for (const std::uint64_t code : codes_)
        low_.push_back(vec3_cast<float>(octree.grid.cell_min(morton_decode(code), level_)));
    sizes_.assign(most_coarser_ + 1, std::vector<std::uint32_t>(domains.node_count));
    tbb::parallel_for(std::uint32_t{0}, domains.node_count, [&](std::uint32_t d) {
        sizes_[0][d] = lobes_[d + 1] - lobes_[d];
        for (std::uint32_t c = 1; c <= most_coarser_; ++c) {
            for (std::uint32_t node = edges_[c][d]; node < edges_[c][d + 1]; ++node) {
                const std::uint32_t first = first_lobe(depth - c, node);
                const std::uint32_t last = first_lobe(depth - c, node + 1);
                sizes_[c][d] += group_cell(octree_.lobes.subspan(first, last - first), {});
            }
        }
    });
}

/// Of a node, or of what follows the last of its level.
std::uint32_t LightDomains::first_lobe(std::uint32_t level, std::uint32_t node) const {
    const Level& here = octree_.levels[level];
    if (node >= here.first_node + here.node_count)
        return static_cast<std::uint32_t>(octree_.lobes.size());
    for (; level < octree_.grid.depth; ++level)
        node = octree_.nodes[node].first;
    return octree_.nodes[node].first;
}

float LightDomains::edge(const OctreeView& octree) {
    return octree.grid.cell_edge(octree.grid.depth - std::min(kMostCoarser, octree.grid.depth));
}

float LightDomains::distance(std::size_t domain, const Vec3f& place) const {
    Vec3f off;
    for (int a = 0; a < 3; ++a)
        off[a] = std::max({low_[domain][a] - place[a], place[a] - low_[domain][a] - edge(), 0.0f});
    return length(off);
}

/// count() where there is none.
std::size_t LightDomains::domain_at(const Vec3f& place) const {
    const Grid& grid = octree_.grid;
    for (int a = 0; a < 3; ++a) {
        if (!(place[a] >= grid.cube_min[a] && place[a] < grid.cube_min[a] + grid.cube_edge))
            return count();
    }
    const std::uint64_t code =
        grid.code_of(vec3_cast<double>(place)) >> (3 * (kMortonLevels - level_));
    const auto found = std::ranges::lower_bound(codes_, code);
    return found != codes_.end() && *found == code
               ? static_cast<std::size_t>(found - codes_.begin())
               : count();
}

std::uint64_t LightDomains::least_groups() const {
    return sizes_.empty()
               ? 0
               : std::accumulate(sizes_.back().begin(), sizes_.back().end(), std::uint64_t{0});
}

LightGroups LightDomains::group(std::vector<std::uint8_t> coarser,
                                std::vector<std::uint8_t> shown) const {
    LightGroups groups;
    groups.shown = shown.empty() ? std::vector<std::uint8_t>(count(), 1) : std::move(shown);
    groups.first_of_domain.push_back(0);
    for (std::size_t d = 0; d < count(); ++d)
        groups.first_of_domain.push_back(groups.first_of_domain.back() + sizes_[coarser[d]][d]);
    groups.coarser = std::move(coarser);
    const std::size_t lobes = octree_.lobes.size();
    groups.starts.resize(groups.count() + std::size_t{1}, static_cast<std::uint32_t>(lobes));
    groups.members.resize(lobes);
    groups.group_of.resize(lobes);
    groups.share.resize(lobes);
    tbb::parallel_for(std::size_t{0}, count(), [&](std::size_t d) {
        const std::uint32_t c = groups.coarser[d], level = octree_.grid.depth - c;
        std::uint32_t group = groups.first_of_domain[d];
        if (c == 0) {
            for (std::uint32_t lobe = lobes_[d]; lobe < lobes_[d + 1]; ++lobe) {
                groups.starts[group] = groups.members[lobe] = lobe;
                groups.group_of[lobe] = group++;
                groups.share[lobe] = 1.0f;
            }
            return;
        }
        std::vector<std::uint8_t> group_of;
        for (std::uint32_t node = edges_[c][d]; node < edges_[c][d + 1]; ++node) {
            const std::uint32_t first = first_lobe(level, node), last = first_lobe(level, node + 1);
            group_of.resize(last - first);
            const std::uint32_t in_cell =
                group_cell(octree_.lobes.subspan(first, last - first), group_of);
            std::uint32_t place = first;
            for (std::uint32_t g = 0; g < in_cell; ++g, ++group) {
                const std::uint32_t start = groups.starts[group] = place;
                float area = 0.0f;
                for (std::uint32_t lobe = first; lobe < last; ++lobe) {
                    if (group_of[lobe - first] != g) continue;
                    area += area_of(octree_.lobes[lobe]);
                    groups.members[place] = lobe;
                    groups.group_of[lobe] = group;
                    groups.share[place++] = area;
                }
                for (std::uint32_t m = start; m < place; ++m)
                    groups.share[m] /= area;
            }
        }
    });
    groups.walls = walls_of(groups);
    return groups;
}

}  // namespace glowworm
