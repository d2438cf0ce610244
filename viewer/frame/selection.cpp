#include "viewer/frame/selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace glowworm {
namespace {

/// Half-space n·p + d >= 0.
struct Plane {
    Vec3d normal;
    double offset;
};

/// The five planes that bound what a view shows: the sides, facing inward, and the eye's.
std::array<Plane, 5> frustum_of(const View& view) {
    const double left = -view.centre_x / view.focal;
    const double right = (view.width - view.centre_x) / view.focal;
    const double top = -view.centre_y / view.focal;
    const double bottom = (view.height - view.centre_y) / view.focal;
    const auto side = [&](const Vec3d& axis, double edge, double sign) {
        // Perspective: x >= edge · depth. Orthographic: x >= edge.
        const Vec3d normal =
            view.orthographic ? axis * sign : normalized((axis - view.forward * edge) * sign);
        const double shift = view.orthographic ? -sign * edge : 0.0;
        return Plane{normal, shift - dot(normal, view.position)};
    };
    return {side(view.right, left, 1), side(view.right, right, -1), side(view.down, top, 1),
            side(view.down, bottom, -1), Plane{view.forward, -dot(view.forward, view.position)}};
}

/// The surfels' own extent reaches past the box of their centres by their drawn radius.
bool may_be_seen(const std::array<Plane, 5>& frustum, const Vec3d& centre, const Vec3d& half,
                 double drawn_radius) {
    for (const Plane& plane : frustum) {
        const Vec3d& n = plane.normal;
        const double reach =
            half.x * std::abs(n.x) + half.y * std::abs(n.y) + half.z * std::abs(n.z) + drawn_radius;
        if (dot(n, centre) + plane.offset + reach < 0) return false;
    }
    return true;
}

bool overlaps(const WorldBox& box, const Vec3d& centre, const Vec3d& half) {
    for (int axis = 0; axis < 3; ++axis) {
        if (centre[axis] + half[axis] < box.low[axis] || centre[axis] - half[axis] > box.high[axis])
            return false;
    }
    return true;
}

double distance_to_box(const Vec3d& point, const Vec3d& centre, const Vec3d& half) {
    Vec3d outside;
    for (int axis = 0; axis < 3; ++axis) {
        outside[axis] = std::max(std::abs(point[axis] - centre[axis]) - half[axis], 0.0);
    }
    return length(outside);
}

}  // namespace

std::uint32_t share_of(const Chunk& chunk, double share) {
    if (chunk.count == 0) return 0;
    return std::clamp(static_cast<std::uint32_t>(std::ceil(share * chunk.count)), 1u, chunk.count);
}

ChunkSelection thinned(const ChunkSelection& selected, std::uint32_t count) {
    if (count >= selected.count) return selected;
    const float coarser = std::sqrt(static_cast<float>(selected.count) / static_cast<float>(count));
    return {selected.chunk, count, selected.scale * coarser, selected.full_depth * coarser};
}

void fit_into(std::vector<ChunkSelection>& selection, std::uint64_t blocks,
              std::uint32_t block_surfels) {
    const auto blocks_at = [&](const ChunkSelection& selected, double share) -> std::uint32_t {
        const std::uint32_t all = (selected.count + block_surfels - 1) / block_surfels;
        return std::max(static_cast<std::uint32_t>(share * all), 1u);
    };
    const auto total_at = [&](double share) {
        std::uint64_t total = 0;
        for (const ChunkSelection& selected : selection)
            total += blocks_at(selected, share);
        return total;
    };
    if (total_at(1.0) <= blocks) return;
    double low = 0.0, high = 1.0;
    for (int halving = 0; halving < 32; ++halving) {
        const double middle = (low + high) / 2.0;
        (total_at(middle) <= blocks ? low : high) = middle;
    }
    for (ChunkSelection& selected : selection)
        selected = thinned(selected, blocks_at(selected, low) * block_surfels);
}

std::vector<ChunkSelection> select_chunks(std::span<const Chunk> chunks,
                                          std::span<const ChunkBox> boxes, const Vec3d& origin,
                                          const View& view, const SelectionSettings& settings) {
    struct Seen {
        ChunkSelection selection;
        double distance;
    };
    const std::array<Plane, 5> frustum = frustum_of(view);
    std::vector<Seen> seen;
    std::uint64_t total = 0;
    for (std::uint32_t i = 0; i < chunks.size(); ++i) {
        const Chunk& chunk = chunks[i];
        if (chunk.count == 0) continue;
        const Vec3d centre = origin + boxes[i].centre, half = boxes[i].half;
        if (!may_be_seen(frustum, centre, half, settings.splat_scale * chunk.max_radius)) continue;
        if (view.clip && !overlaps(*view.clip, centre, half)) continue;

        // A prefix of n surfels lies spacing · sqrt(count / n) apart.
        const double distance = distance_to_box(view.position, centre, half);
        const double metre = view.orthographic ? view.focal
                             : distance > 0    ? view.focal / distance
                                               : std::numeric_limits<double>::infinity();
        const double spacing = chunk.spacing * metre / settings.quality;
        const double share = spacing > 0 ? std::min(spacing * spacing, 1.0) : 1.0;
        seen.push_back({{i, share_of(chunk, share), 0.0f, 0.0f}, distance});
        total += seen.back().selection.count;
    }
    std::stable_sort(seen.begin(), seen.end(),
                     [](const Seen& a, const Seen& b) { return a.distance < b.distance; });

    std::vector<ChunkSelection> selections;
    selections.reserve(seen.size());
    const double kept =
        settings.most_surfels > 0 && total > settings.most_surfels
            ? static_cast<double>(settings.most_surfels) / static_cast<double>(total)
            : 1.0;
    for (const Seen& s : seen) {
        const Chunk& chunk = chunks[s.selection.chunk];
        const std::uint32_t count = kept < 1.0
                                        ? share_of(chunk, kept * s.selection.count / chunk.count)
                                        : s.selection.count;
        const float thinned =
            std::sqrt(static_cast<float>(chunk.count) / static_cast<float>(count));
        // As deep as the spacing of these is what `quality` asks for.
        const double full_depth = view.orthographic ? std::numeric_limits<double>::infinity()
                                                    : chunk.spacing * view.focal / settings.quality;
        selections.push_back({s.selection.chunk, count, settings.splat_scale * thinned,
                              static_cast<float>(full_depth) * thinned});
    }
    return selections;
}

}  // namespace glowworm
