#include "preprocess/surface/orientation.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "preprocess/surface/free_side.h"

namespace glowworm {
namespace {

/// Cosine between normal and view under which the neighbours are asked: normals of noisy scans are
/// off by a few degrees.
constexpr float kFlatView = 0.15f;

/// Share of a component's rays by which one side must be the more open one to tell them apart.
constexpr double kClearBalance = 0.02;

/// A closed side whose chords are shorter than this on average, m, holds no scanner: what was
/// scanned is a thing, from outside. The chords of a tube are as long as it is wide.
constexpr double kNarrowest = 0.4;

bool has_normal(const LocalPlane& plane) {
    return plane.area > 0.0f;
}

void turn(LocalPlane& plane) {
    plane.normal = -plane.normal;
    plane.height = -plane.height;
}

/// Cosine between the normal of point i and the direction to its viewpoint; 0 without either.
float view_cosine(const SurfacePoints& points, const LocalPlane& plane, std::size_t i) {
    if (!has_normal(plane) || !points.is_viewed(i)) return 0.0f;
    const Vec3f view = points.toward_viewpoint(i);
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

/// Where the sides of a component, its front and its back, lead.
struct ComponentSides {
    SideEvidence::Side front, back;
    double up = 0.0;    ///< m²: area seen from above minus that seen from below
    double area = 0.0;  ///< m²
    std::size_t points = 0;
};

void add(SideEvidence::Side& sum, const SideEvidence::Side& side) {
    sum.hits += side.hits;
    sum.escapes += side.escapes;
    sum.distance += side.distance;
}

/// Whether the back is the free side, and which evidence said so.
std::pair<bool, FreeSideRule> free_side_of(const ComponentSides& sides) {
    const double rays = sides.front.hits + sides.front.escapes;
    const double balance = sides.back.escapes - sides.front.escapes;
    if (std::abs(balance) < kClearBalance * rays || rays == 0.0) {
        return {sides.up < 0.0, FreeSideRule::kUnclear};
    }
    const SideEvidence::Side& closed = balance > 0.0 ? sides.front : sides.back;
    const bool holds_a_scanner = closed.distance > kNarrowest * closed.hits;
    if (!holds_a_scanner) return {balance > 0.0, FreeSideRule::kOpenSide};
    return {balance < 0.0, FreeSideRule::kClosedSide};
}

/// Turns the points without a station: patches of neighbours that agree are joined to components by
/// what their borders and the rays between them say, and by the stations that saw some of them; a
/// component that no station saw faces its free side.
void propagate(const SurfacePoints& points, const NeighbourTable& table, float noise,
               std::vector<LocalPlane>& planes, OrientationReport& report) {
    const std::size_t n = points.size();
    const NormalPatches patches = make_normal_patches(points, table, planes, noise);
    const SideEvidence seen = look_around(points, planes, patches);

    // One patch more stands for all stations: its front is what they see.
    const auto stations = static_cast<std::uint32_t>(patches.count);
    std::vector<PatchLink> links = link_neighbours(points, table, planes, patches, noise);
    links.insert(links.end(), seen.links.begin(), seen.links.end());
    for (std::size_t i = 0; i < n && report.toward_stations > 0; ++i) {
        const float cosine = view_cosine(points, planes[i], i);
        const std::uint32_t of = patches.of[i];
        if (cosine != 0.0f) links.push_back({of >> 1, stations, of & 1 ? -cosine : cosine});
    }
    links = sum_links(std::move(links));
    const std::vector<std::uint32_t> component = join_patches(patches.count + 1, links);
    links = {};

    std::vector<ComponentSides> sides(patches.count + 1);
    for (std::size_t p = 0; p < patches.count; ++p) {
        ComponentSides& whole = sides[component[p] >> 1];
        const bool turned = component[p] & 1;
        add(whole.front, turned ? seen.back[p] : seen.front[p]);
        add(whole.back, turned ? seen.front[p] : seen.back[p]);
    }
    const auto is_turned = [&](std::size_t i) {
        return ((component[patches.of[i] >> 1] ^ patches.of[i]) & 1) != 0;
    };
    for (std::size_t i = 0; i < n; ++i) {
        if (patches.of[i] == kNoPatch) continue;
        ComponentSides& whole = sides[component[patches.of[i] >> 1] >> 1];
        const double up = static_cast<double>(planes[i].normal.z) * planes[i].area;
        whole.up += is_turned(i) ? -up : up;
        ++whole.points;
    }

    std::vector<std::uint8_t> back_is_free(patches.count + 1, 0);
    for (std::size_t c = 0; c < sides.size(); ++c) {
        if (sides[c].points == 0) continue;
        if (c == component[stations] >> 1) {
            back_is_free[c] = component[stations] & 1;
            continue;
        }
        const auto [back, rule] = free_side_of(sides[c]);
        back_is_free[c] = back;
        report.by_rule[static_cast<std::size_t>(rule)] += sides[c].points;
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (patches.of[i] == kNoPatch || points.is_viewed(i)) continue;
        const bool back = back_is_free[component[patches.of[i] >> 1] >> 1] != 0;
        if (is_turned(i) != back) turn(planes[i]);
    }
}

}  // namespace

OrientationReport orient_normals(const SurfacePoints& points, const NeighbourTable& table,
                                 float noise, std::vector<LocalPlane>& planes) {
    OrientationReport report;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!has_normal(planes[i])) continue;
        ++(points.is_viewed(i) ? report.toward_stations : report.propagated);
    }
    if (report.toward_stations > 0) report.unsure += face_stations(points, table, planes);
    if (report.propagated > 0) propagate(points, table, noise, planes, report);
    report.unsure += report.of(FreeSideRule::kUnclear);
    return report;
}

}  // namespace glowworm
