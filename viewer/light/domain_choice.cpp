// How coarse each domain is, and where its light is shown.
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "octree/trace.h"
#include "viewer/light/domains.h"

namespace glowworm {
namespace {

constexpr float kNear = 0.25f;                 // domain edges: no domain lies nearer to a focus
constexpr float kUnseen = 2.0f;                // times as far
constexpr float kFine = 64.0f;                 // leaf edges: nearer lobes have light of their own
constexpr float kShown = 3.0f;                 // domain edges
constexpr std::uint32_t kRaysToSee = 1 << 10;  // of a focus
constexpr std::uint32_t kRaysToShow = 1 << 14;
constexpr std::size_t kFociThatSee = 16;

}  // namespace

std::vector<std::uint8_t> LightDomains::seen_from(std::span<const Focus> foci,
                                                  std::uint32_t rays) const {
    std::vector<std::uint8_t> seen(count(), 0);
    const std::size_t looking = std::min(foci.size(), kFociThatSee);
    for (const Focus& focus : foci.first(looking)) {
        std::vector<std::uint32_t> met(rays);
        tbb::parallel_for(std::size_t{0}, met.size(), [&](std::size_t i) {
            const auto k = static_cast<double>(i);
            const double z = 1.0 - (2.0 * k + 1.0) / static_cast<double>(met.size());
            const double turn = 2.0 * std::numbers::pi * std::numbers::phi * k;
            const double r = std::sqrt(1.0 - z * z);
            Ray ray;
            ray.origin = focus.position;
            ray.direction = vec3_cast<float>(Vec3d{r * std::cos(turn), r * std::sin(turn), z});
            met[i] = trace_ray(octree_, {}, ray).lobe;
        });
        for (const std::uint32_t lobe : met) {
            if (lobe >= octree_.lobes.size()) continue;
            const auto after = std::upper_bound(lobes_.begin(), lobes_.end(), lobe);
            seen[static_cast<std::size_t>(after - lobes_.begin()) - 1] = 1;
        }
    }
    return seen;
}

std::vector<std::uint8_t> LightDomains::choose(std::span<const Focus> foci,
                                               std::uint64_t most_groups) const {
    const std::vector<std::uint8_t> seen = seen_from(foci, kRaysToSee);
    std::vector<float> far(count(), foci.empty() ? 1.0f : 1e30f);
    tbb::parallel_for(std::size_t{0}, count(), [&](std::size_t d) {
        for (const Focus& focus : foci) {
            const float off = std::max(distance(d, focus.position), kNear * edge());
            far[d] = std::min(far[d], off * focus.remote);
        }
        far[d] *= seen[d] != 0 ? 1.0f : kUnseen;
    });
    const auto levels_within = [&](float radius) {
        std::vector<std::uint8_t> coarser(count());
        for (std::size_t d = 0; d < count(); ++d) {
            const float doublings = std::log2(std::max(far[d], 1e-6f) / radius);
            coarser[d] = static_cast<std::uint8_t>(std::clamp(
                static_cast<int>(std::floor(doublings)) + 1, 0, static_cast<int>(most_coarser_)));
        }
        return coarser;
    };
    const auto groups_of = [&](const std::vector<std::uint8_t>& coarser) {
        std::uint64_t sum = 0;
        for (std::size_t d = 0; d < count(); ++d)
            sum += sizes_[coarser[d]][d];
        return sum;
    };
    if (octree_.lobes.size() <= most_groups) return std::vector<std::uint8_t>(count(), 0);
    float low = 1e-3f * edge(), high = kFine * octree_.grid.voxel_size();
    if (!foci.empty() && groups_of(levels_within(high)) <= most_groups) return levels_within(high);
    if (foci.empty()) high = 4.0f * octree_.grid.cube_edge;
    for (int halvings = 0; halvings < 40; ++halvings) {
        const float radius = std::sqrt(low * high);
        (groups_of(levels_within(radius)) <= most_groups ? low : high) = radius;
    }
    std::vector<std::uint8_t> chosen = levels_within(low);
    if (groups_of(chosen) <= most_groups) return chosen;
    return std::vector<std::uint8_t>(count(), static_cast<std::uint8_t>(most_coarser_));
}

std::vector<std::uint8_t> LightDomains::shown_to(std::span<const Focus> foci) const {
    std::vector<Focus> eyes;
    std::ranges::copy_if(foci, std::back_inserter(eyes),
                         [](const Focus& focus) { return focus.is_eye(); });
    const std::vector<std::uint8_t> seen = seen_from(eyes, kRaysToShow);
    std::vector<std::uint8_t> shown(count(), 0);
    tbb::parallel_for(std::size_t{0}, count(), [&](std::size_t d) {
        const Vec3f middle = low_[d] + Vec3f{0.5f, 0.5f, 0.5f} * edge();
        bool is_shown = std::ranges::any_of(
            eyes, [&](const Focus& eye) { return distance(d, eye.position) <= kShown * edge(); });
        for (int step = 0; step < 27 && !is_shown; ++step) {
            const Vec3f toward{static_cast<float>(step % 3 - 1),
                               static_cast<float>(step / 3 % 3 - 1),
                               static_cast<float>(step / 9 - 1)};
            const std::size_t beside = domain_at(middle + toward * edge());
            is_shown = beside < count() && seen[beside] != 0;
        }
        shown[d] = is_shown ? 1 : 0;
    });
    return shown;
}

}  // namespace glowworm
