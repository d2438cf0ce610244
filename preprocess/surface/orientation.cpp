#include "preprocess/surface/orientation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "octree/error.h"
#include "preprocess/surface/free_side.h"
#include "preprocess/surface/parity_forest.h"

namespace glowworm {
namespace {

/// Cosine between normal and view under which the neighbours are asked: normals of noisy scans are
/// off by a few degrees.
constexpr float kFlatView = 0.15f;

/// Edges of the spanning tree are packed: a point in the upper bits, a column of the table below.
constexpr std::uint32_t kColumnBits = 4;

/// Points of a component that vote on its free side.
constexpr std::size_t kVoters = 512;

bool has_normal(const LocalPlane& plane) {
    return plane.area > 0.0f;
}

void turn(LocalPlane& plane) {
    plane.normal = -plane.normal;
    plane.height = -plane.height;
}

/// Cosine between the normal of point i and the direction to its station; 0 without either.
float view_cosine(const SurfacePoints& points, const LocalPlane& plane, std::size_t i) {
    if (!has_normal(plane) || !points.is_viewed(i)) return 0.0f;
    const Vec3f view = points.toward_station(i);
    const float distance = length(view);
    return distance > 0.0f ? dot(plane.normal, view) / distance : 0.0f;
}

/// Turns every normal to its station, then those seen flatly as their clearly seen neighbours.
/// Returns how many stayed unclear.
std::size_t face_stations(const SurfacePoints& points, const NeighbourTable& table,
                          std::vector<LocalPlane>& planes) {
    const std::size_t n = points.size();
    std::vector<float> cosines(n);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n, 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            const float cosine = view_cosine(points, planes[i], i);
            if (cosine < 0.0f) turn(planes[i]);
            cosines[i] = std::abs(cosine);
        }
    });
    std::vector<std::uint32_t> flat;
    for (std::size_t i = 0; i < n; ++i) {
        if (cosines[i] < kFlatView && has_normal(planes[i]) && points.is_viewed(i)) {
            flat.push_back(static_cast<std::uint32_t>(i));
        }
    }
    std::vector<float> votes(flat.size());
    tbb::parallel_for(std::size_t{0}, flat.size(), [&](std::size_t f) {
        float vote = cosines[flat[f]];
        for (const std::uint32_t j : table.of(flat[f])) {
            if (cosines[j] < kFlatView) continue;
            vote += cosines[j] * dot(planes[flat[f]].normal, planes[j].normal);
        }
        votes[f] = vote;
    });
    std::size_t unclear = 0;
    for (std::size_t f = 0; f < flat.size(); ++f) {
        if (votes[f] < 0.0f) turn(planes[flat[f]]);
        if (std::abs(votes[f]) < kFlatView) ++unclear;
    }
    return unclear;
}

/// Kruskal's minimal spanning forest over the table, the most parallel normals first. Weights in
/// 256 steps, so that sorting is counting and the order does not depend on threads.
ParityForest spanning_forest(const SurfacePoints& points, const NeighbourTable& table,
                             const std::vector<LocalPlane>& planes) {
    const std::size_t n = points.size();
    if (n >> (32 - kColumnBits) != 0 || table.count > 1 << kColumnBits) {
        throw Error(
            ExitCode::kBudget,
            "More than 268 million points cannot be oriented at once without stations; thin "
            "the cloud or split it.");
    }
    const auto weight = [&](std::size_t i, std::size_t j) {
        const float c = std::abs(dot(planes[i].normal, planes[j].normal));
        return static_cast<std::size_t>(std::clamp((1.0f - c) * 255.0f, 0.0f, 255.0f));
    };
    const auto for_each_edge = [&](auto visit) {
        for (std::size_t i = 0; i < n; ++i) {
            if (!has_normal(planes[i])) continue;
            const auto row = table.of(i);
            for (std::size_t c = 0; c < row.size(); ++c) {
                const std::size_t j = row[c];
                // Of two that are each other's neighbours the first has the edge.
                if (j < i && std::ranges::find(table.of(j), i) != table.of(j).end()) continue;
                if (has_normal(planes[j])) visit(i, c, weight(i, j));
            }
        }
    };
    std::array<std::size_t, 257> begin{};
    for_each_edge([&](std::size_t, std::size_t, std::size_t w) { ++begin[w + 1]; });
    for (std::size_t w = 0; w < 256; ++w)
        begin[w + 1] += begin[w];
    std::vector<std::uint32_t> edges(begin[256]);
    for_each_edge([&](std::size_t i, std::size_t c, std::size_t w) {
        edges[begin[w]++] = static_cast<std::uint32_t>(i << kColumnBits | c);
    });

    ParityForest forest(n);
    for (const std::uint32_t edge : edges) {
        const std::uint32_t i = edge >> kColumnBits;
        const std::uint32_t j = table.of(i)[edge & ((1u << kColumnBits) - 1)];
        forest.join(i, j, dot(planes[i].normal, planes[j].normal) < 0.0f);
    }
    return forest;
}

/// Turns the points without a station. A component's side is the one its points with stations
/// have, weighted by how squarely they were seen, else the one its voters see surface from.
std::size_t propagate(const SurfacePoints& points, const NeighbourTable& table, float spacing,
                      std::vector<LocalPlane>& planes) {
    const std::size_t n = points.size();
    ParityForest forest = spanning_forest(points, table, planes);
    std::vector<std::uint32_t> root(n);
    std::vector<std::uint32_t> size(n, 0);
    std::vector<double> side(n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const auto [r, opposite] = forest.find(static_cast<std::uint32_t>(i));
        root[i] = r << 1 | static_cast<std::uint32_t>(opposite);
        if (!has_normal(planes[i])) continue;
        ++size[r];
        const double cosine = view_cosine(points, planes[i], i);
        side[r] += opposite ? -cosine : cosine;
    }

    // The voters of a component are spread evenly over it.
    std::vector<std::uint32_t> voters, seen(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
        const std::uint32_t r = root[i] >> 1;
        if (!has_normal(planes[i]) || side[r] != 0.0) continue;
        const std::size_t every = std::max<std::size_t>(size[r] / kVoters, 1);
        if (seen[r]++ % every == 0) voters.push_back(static_cast<std::uint32_t>(i));
    }
    std::vector<double> votes(n, 0.0);
    if (!voters.empty()) {
        const FreeSide free_side(points, 3.0f * spacing);
        std::vector<int> balance(voters.size());
        tbb::parallel_for(std::size_t{0}, voters.size(), [&](std::size_t v) {
            balance[v] = free_side.vote(voters[v], planes[voters[v]].normal);
        });
        for (std::size_t v = 0; v < voters.size(); ++v) {
            const std::uint32_t r = root[voters[v]];
            votes[r >> 1] += r & 1 ? -balance[v] : balance[v];
        }
    }

    std::size_t unsure = 0;
    for (std::size_t i = 0; i < n; ++i) {
        if (!has_normal(planes[i]) || points.is_viewed(i)) continue;
        const std::uint32_t r = root[i] >> 1;
        const double decided = side[r] != 0.0 ? side[r] : votes[r];
        const bool opposite = root[i] & 1;
        if (opposite != (decided < 0.0)) turn(planes[i]);
        const double cast = std::min<double>(size[r], kVoters) * FreeSide::kRays;
        if (side[r] == 0.0 && std::abs(votes[r]) < 0.05 * cast) ++unsure;
    }
    return unsure;
}

}  // namespace

OrientationReport orient_normals(const SurfacePoints& points, const NeighbourTable& table,
                                 float spacing, std::vector<LocalPlane>& planes) {
    OrientationReport report;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!has_normal(planes[i])) continue;
        ++(points.is_viewed(i) ? report.toward_stations : report.propagated);
    }
    if (report.toward_stations > 0) report.unsure += face_stations(points, table, planes);
    if (report.propagated > 0) report.unsure += propagate(points, table, spacing, planes);
    return report;
}

}  // namespace glowworm
