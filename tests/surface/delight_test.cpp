#include "preprocess/surface/delight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <vector>

#include "preprocess/surface/albedo.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

struct Lit {
    SurfelCloud cloud;
    std::vector<double> albedo;  ///< [surfels] true
};

/// A rough tube of 3 m bore along x, its albedo in stripes of 0.5 m, with a station every 4 m off
/// its axis whose light falls off as distance^-p · cosine^q; each sees `reach` metres both ways.
Lit make_lit_tube(double p, double q, const std::vector<double>& gains, double reach) {
    Lit lit;
    testing::Random random(9);
    const auto count = static_cast<double>(gains.size());
    for (std::size_t s = 0; s < gains.size(); ++s) {
        const double x = 4.0 * static_cast<double>(s);
        lit.cloud.stations.push_back(testing::station_at({x, s % 2 ? 0.6 : -0.5, 0.4}));
    }
    while (lit.albedo.size() < 120000) {
        const auto s = static_cast<std::uint32_t>(random.uniform(0, count));
        const Vec3d station = lit.cloud.stations[s].position;
        const double x = station.x + random.uniform(-reach, reach);
        const double phi = random.uniform(0, 2.0 * std::numbers::pi);
        const Vec3d outward{0, std::cos(phi), std::sin(phi)};
        const Vec3d at = outward * 1.5 + Vec3d{x, 0, 0};
        const Vec3d normal =
            normalized(Vec3d{0.5 * std::sin(5.0 * x), 0.4 * std::cos(3.0 * phi), 0} - outward);
        const double distance = length(station - at);
        const double cosine = dot(station - at, normal) / distance;
        if (cosine < 0.05) continue;
        const double albedo = static_cast<int>(std::floor(x * 2.0)) % 2 ? 0.25 : 0.4;
        const double light = gains[s] * std::pow(distance, -p) * std::pow(cosine, q);
        Surfel surfel;
        surfel.position = vec3_cast<float>(at);
        surfel.normal = vec3_cast<float>(normal);
        surfel.radius = 0.01f;
        const auto colour =
            static_cast<float>(std::min(albedo * light * std::exp(0.03 * random.gauss()), 1.0));
        surfel.albedo = to_linear(to_srgb({colour, colour, colour}));
        surfel.station = s;
        lit.cloud.surfels.push_back(surfel);
        lit.albedo.push_back(albedo);
    }
    return lit;
}

/// Relative error of the albedo, one scale for all taken out: median.
double albedo_error(const Lit& lit) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < lit.albedo.size(); ++i)
        ratios.push_back(lit.cloud.surfels[i].albedo.y / lit.albedo[i]);
    std::vector<double> sorted = ratios;
    std::ranges::sort(sorted);
    const double scale = sorted[sorted.size() / 2];
    for (double& ratio : ratios)
        ratio = std::abs(ratio / scale - 1.0);
    std::ranges::sort(ratios);
    return ratios[ratios.size() / 2];
}

TEST(Delight, TheFalloffOfAKnownLightIsFoundAndTakenOut) {
    for (const auto& [p, q] : {std::pair{2.0, 1.0}, std::pair{1.2, 0.5}, std::pair{0.0, 0.0}}) {
        Lit lit = make_lit_tube(p, q, {1.0, 0.7, 1.2}, 4.0);
        const double before = albedo_error(lit);
        const DelightReport report = delight(lit.cloud);
        std::printf(
            "    p %.2f, true %.2f; q %.2f, true %.2f; %zu pairs; albedo off by %.1f %%, before "
            "%.1f %%\n",
            report.distance_exponent, p, report.incidence_exponent, q, report.pairs,
            100 * albedo_error(lit), 100 * before);
        EXPECT_TRUE(report.applied) << report.reason;
        EXPECT_NEAR(report.distance_exponent, p, 0.1);
        EXPECT_NEAR(report.incidence_exponent, q, 0.1);
        EXPECT_LT(albedo_error(lit), 0.05);
        EXPECT_LT(report.rms_after, 0.5 * report.rms_before);
    }
}

TEST(Delight, WhereNothingOverlapsNothingChangesAndThatIsSaid) {
    for (const bool one : {true, false}) {
        Lit lit = make_lit_tube(2.0, 1.0, one ? std::vector{1.0} : std::vector{1.0, 1.0}, 1.8);
        const SurfelCloud before = lit.cloud;
        const DelightReport report = delight(lit.cloud);
        EXPECT_FALSE(report.applied);
        EXPECT_FALSE(report.reason.empty());
        EXPECT_EQ(std::memcmp(before.surfels.data(), lit.cloud.surfels.data(),
                              before.surfels.size() * sizeof(Surfel)),
                  0);
    }
    SurfelCloud nothing;
    EXPECT_FALSE(delight(nothing).applied);
}

}  // namespace
}  // namespace glowworm
