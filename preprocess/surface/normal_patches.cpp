#include "preprocess/surface/normal_patches.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "preprocess/surface/parity_forest.h"

namespace glowworm {
namespace {

/// Points of a block: their neighbours' links fit in a core's cache.
constexpr std::size_t kBlock = 2048;
constexpr std::size_t kBlocksAtOnce = 64;  // whose links are put together before the next ones

/// Agreement that joins two points to a patch; less joins only crumbs of fewer points than this.
constexpr float kSure = 0.95f;
constexpr std::uint32_t kCrumb = 16;

/// Agreement below this says nothing.
constexpr float kSilent = 0.2f;

/// How loud the turn of a corner is beside a smooth surface.
constexpr float kCorner = 0.1f;

bool has_normal(const LocalPlane& plane) {
    return plane.area > 0.0f;
}

/// What two neighbours say about their sides.
struct Agreement {
    float side;    ///< 1: the same, -1: opposite ones, 0: unknown
    float smooth;  ///< 0..1: how sure it is that both lie on one smooth surface
};

/// One normal is mirrored in the bisecting plane of the points, as an arc through both would carry
/// it over. Where three surfaces meet in an edge two of the arcs are wrong, so the corners that
/// they turn are heard but do not join.
Agreement agreement(const SurfacePoints& points, const std::vector<LocalPlane>& planes,
                    std::size_t i, std::size_t j, float noise) {
    const LocalPlane& a = planes[i];
    const LocalPlane& b = planes[j];
    const Vec3f between = points.tree.position(j) + b.normal * b.height - points.tree.position(i) -
                          a.normal * a.height;
    const float softened = dot(between, between) + 4.0f * noise * noise;
    const float flat = dot(a.normal, b.normal);
    if (!(softened > 0.0f)) return {flat, std::abs(flat)};
    const float arc = flat - 2.0f * dot(between, a.normal) * dot(between, b.normal) / softened;
    const float smooth = arc * flat > 0.0f ? std::min(std::abs(arc), std::abs(flat)) : 0.0f;
    return {arc, smooth};
}

std::size_t block_count(std::size_t n) {
    return (n + kBlock - 1) / kBlock;
}

struct Edge {
    float weight;  // smoothness
    std::uint32_t a, b;
    bool opposite;
};

/// Labels the points of one block from 0; returns how many labels there are.
std::uint32_t label_block(const SurfacePoints& points, const NeighbourTable& table,
                          const std::vector<LocalPlane>& planes, float noise, std::size_t begin,
                          std::size_t end, std::vector<Edge>& edges,
                          std::vector<std::uint32_t>& labels) {
    edges.clear();
    for (std::size_t i = begin; i < end; ++i) {
        if (!has_normal(planes[i])) continue;
        for (const std::uint32_t j : table.of(i)) {
            if (j < begin || j >= end || !has_normal(planes[j])) continue;
            const Agreement a = agreement(points, planes, i, j, noise);
            if (a.smooth < kSilent) continue;
            edges.push_back({a.smooth, static_cast<std::uint32_t>(i - begin),
                             static_cast<std::uint32_t>(j - begin), a.side < 0.0f});
        }
    }
    std::sort(edges.begin(), edges.end(), [](const Edge& p, const Edge& q) {
        if (p.weight != q.weight) return p.weight > q.weight;
        return p.a != q.a ? p.a < q.a : p.b < q.b;
    });
    ParityForest forest(end - begin);
    std::vector<std::uint32_t> size(end - begin, 1);
    for (const Edge& edge : edges) {
        const std::uint32_t a = forest.find(edge.a).first, b = forest.find(edge.b).first;
        if (a == b) continue;
        if (edge.weight < kSure && std::min(size[a], size[b]) >= kCrumb) continue;
        const std::uint32_t sum = size[a] + size[b];
        forest.join(edge.a, edge.b, edge.opposite);
        size[std::min(a, b)] = sum;
    }
    std::vector<std::uint32_t> label(end - begin, kNoPatch);
    std::uint32_t count = 0;
    for (std::size_t i = begin; i < end; ++i) {
        if (!has_normal(planes[i])) continue;
        const auto [root, opposite] = forest.find(static_cast<std::uint32_t>(i - begin));
        if (label[root] == kNoPatch) label[root] = count++;
        labels[i] = label[root] << 1 | static_cast<std::uint32_t>(opposite);
    }
    return count;
}

}  // namespace

NormalPatches make_normal_patches(const SurfacePoints& points, const NeighbourTable& table,
                                  const std::vector<LocalPlane>& planes, float noise) {
    const std::size_t n = points.size(), blocks = block_count(n);
    NormalPatches patches;
    patches.of.assign(n, kNoPatch);
    std::vector<std::uint32_t> counts(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        std::vector<Edge> edges;
        const std::size_t begin = block * kBlock, end = std::min(begin + kBlock, n);
        counts[block] = label_block(points, table, planes, noise, begin, end, edges, patches.of);
    });
    for (std::size_t block = 0; block < blocks; ++block) {
        const auto base = static_cast<std::uint32_t>(patches.count) << 1;
        for (std::size_t i = block * kBlock; i < std::min((block + 1) * kBlock, n); ++i) {
            if (patches.of[i] != kNoPatch) patches.of[i] += base;
        }
        patches.count += counts[block];
    }
    return patches;
}

std::vector<PatchLink> sum_links(std::vector<PatchLink> links) {
    for (PatchLink& link : links) {
        if (link.a > link.b) std::swap(link.a, link.b);
    }
    tbb::parallel_sort(links.begin(), links.end(), [](const PatchLink& p, const PatchLink& q) {
        if (p.a != q.a) return p.a < q.a;
        return p.b != q.b ? p.b < q.b : p.agreement < q.agreement;
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < links.size();) {
        PatchLink sum = links[i++];
        for (; i < links.size() && links[i].a == sum.a && links[i].b == sum.b; ++i)
            sum.agreement += links[i].agreement;
        if (sum.a != sum.b) links[kept++] = sum;
    }
    links.resize(kept);
    return links;
}

std::vector<PatchLink> link_neighbours(const SurfacePoints& points, const NeighbourTable& table,
                                       const std::vector<LocalPlane>& planes,
                                       const NormalPatches& patches, float noise) {
    const std::size_t n = points.size(), blocks = block_count(n);
    std::vector<PatchLink> links;
    std::vector<std::vector<PatchLink>> of_block(std::min(blocks, kBlocksAtOnce));
    for (std::size_t first = 0; first < blocks; first += kBlocksAtOnce) {
        const std::size_t count = std::min(blocks - first, kBlocksAtOnce);
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t b) {
            std::vector<PatchLink>& own = of_block[b];
            own.clear();
            const std::size_t begin = (first + b) * kBlock, end = std::min(begin + kBlock, n);
            for (std::size_t i = begin; i < end; ++i) {
                if (patches.of[i] == kNoPatch) continue;
                for (const std::uint32_t j : table.of(i)) {
                    if (patches.of[j] == kNoPatch || patches.of[i] >> 1 == patches.of[j] >> 1)
                        continue;
                    const Agreement a = agreement(points, planes, i, j, noise);
                    if (std::abs(a.side) < kSilent) continue;
                    const bool opposite = (patches.of[i] ^ patches.of[j]) & 1;
                    const float said = a.side * (kCorner + (1.0f - kCorner) * a.smooth);
                    own.push_back(
                        {patches.of[i] >> 1, patches.of[j] >> 1, opposite ? -said : said});
                }
            }
            own = sum_links(std::move(own));
        });
        for (std::size_t b = 0; b < count; ++b)
            links.insert(links.end(), of_block[b].begin(), of_block[b].end());
    }
    return sum_links(std::move(links));
}

}  // namespace glowworm
