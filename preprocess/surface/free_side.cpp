#include "preprocess/surface/free_side.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "preprocess/surface/disc_cast.h"

namespace glowworm {
namespace {

/// Rays to each side of a point, and points that look around: of a patch and in all, at most.
constexpr int kRays = 8;
constexpr std::size_t kLookers = 24;
constexpr std::size_t kAllLookers = 100000;

/// How loud one ray is beside one pair of neighbours.
constexpr float kRayWeight = 0.5f;

constexpr float kFarthestRay = std::numeric_limits<float>::max();

/// Directions into the half space of `normal`, spread evenly by cosine and turned by `turn`, rad.
/// The flattest are left out: they graze the surface that they leave.
std::array<Vec3f, kRays> directions_about(const Vec3f& normal, float turn) {
    const Vec3f axis = std::abs(normal.x) < 0.6f ? Vec3f{1, 0, 0} : Vec3f{0, 1, 0};
    const Vec3f u = normalized(cross(normal, axis));
    const Vec3f v = cross(normal, u);
    constexpr float kGoldenAngle = 2.39996323f;
    std::array<Vec3f, kRays> directions;
    for (int r = 0; r < kRays; ++r) {
        const float sine2 = 0.9f * (static_cast<float>(r) + 0.5f) / kRays;
        const float phi = turn + kGoldenAngle * static_cast<float>(r);
        const float sine = std::sqrt(sine2);
        directions[static_cast<std::size_t>(r)] = normal * std::sqrt(1.0f - sine2) +
                                                  u * (sine * std::cos(phi)) +
                                                  v * (sine * std::sin(phi));
    }
    return directions;
}

/// Points that look around, spread evenly over each patch.
std::vector<std::uint32_t> choose_lookers(const NormalPatches& patches) {
    std::vector<std::uint32_t> size(patches.count, 0), seen(patches.count, 0);
    for (const std::uint32_t of : patches.of) {
        if (of != kNoPatch) ++size[of >> 1];
    }
    const std::size_t per_patch =
        std::clamp<std::size_t>(kAllLookers / std::max<std::size_t>(patches.count, 1), 1, kLookers);
    std::vector<std::uint32_t> lookers;
    for (std::size_t i = 0; i < patches.of.size(); ++i) {
        if (patches.of[i] == kNoPatch) continue;
        const std::uint32_t patch = patches.of[i] >> 1;
        const std::size_t every = std::max<std::size_t>(size[patch] / per_patch, 1);
        if (seen[patch]++ % every == every / 2) lookers.push_back(static_cast<std::uint32_t>(i));
    }
    if (lookers.size() <= kAllLookers) return lookers;
    const std::size_t all = lookers.size();
    for (std::size_t k = 0; k < kAllLookers; ++k)
        lookers[k] = lookers[k * all / kAllLookers];
    lookers.resize(kAllLookers);
    return lookers;
}

}  // namespace

SideEvidence look_around(const SurfacePoints& points, const std::vector<LocalPlane>& planes,
                         const NormalPatches& patches) {
    const std::vector<std::uint32_t> lookers = choose_lookers(patches);
    const DiscCast cast(points, planes);
    struct View {
        std::array<DiscCast::Hit, kRays> front, back;
    };
    std::vector<View> views(lookers.size());
    tbb::parallel_for(std::size_t{0}, lookers.size(), [&](std::size_t l) {
        const std::uint32_t i = lookers[l];
        const LocalPlane& plane = planes[i];
        const Vec3f from = points.tree.position(i) + plane.normal * plane.height;
        const auto directions = directions_about(plane.normal, static_cast<float>(l % 64));
        for (std::size_t r = 0; r < kRays; ++r) {
            const float nearest = cast.clearance(i, dot(plane.normal, directions[r]));
            views[l].front[r] = cast.first(from, directions[r], nearest, kFarthestRay);
            views[l].back[r] = cast.first(from, -directions[r], nearest, kFarthestRay);
        }
    });

    SideEvidence evidence;
    evidence.front.resize(patches.count);
    evidence.back.resize(patches.count);
    for (std::size_t l = 0; l < lookers.size(); ++l) {
        const std::uint32_t i = lookers[l], of = patches.of[i];
        const auto directions = directions_about(planes[i].normal, static_cast<float>(l % 64));
        for (const bool is_front : {true, false}) {
            const bool turned = of & 1;
            SideEvidence::Side& side =
                (is_front != turned ? evidence.front : evidence.back)[of >> 1];
            for (std::size_t r = 0; r < kRays; ++r) {
                const DiscCast::Hit& hit = is_front ? views[l].front[r] : views[l].back[r];
                if (hit.point == kNoNeighbour) {
                    side.escapes += 1.0;
                    continue;
                }
                side.hits += 1.0;
                side.distance += hit.distance;
                const std::uint32_t other = patches.of[hit.point];
                if (other >> 1 == of >> 1) continue;
                // Both from the patches' own fronts.
                float facing = -dot(planes[hit.point].normal, directions[r]);
                if ((of ^ other) & 1) facing = -facing;
                evidence.links.push_back({of >> 1, other >> 1, kRayWeight * facing});
            }
        }
    }
    return evidence;
}

}  // namespace glowworm
