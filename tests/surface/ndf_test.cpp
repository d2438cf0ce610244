#include "preprocess/surface/ndf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "preprocess/surface/surface.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

/// A unit vector about z from a von Mises-Fisher lobe (Wood 1994, in three dimensions closed).
Vec3f draw_vmf(testing::Random& random, double kappa) {
    const double u = random.uniform();
    const double w = 1.0 + std::log(u + (1.0 - u) * std::exp(-2.0 * kappa)) / kappa;
    const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double r = std::sqrt(std::max(1.0 - w * w, 0.0));
    return vec3_cast<float>(Vec3d{r * std::cos(phi), r * std::sin(phi), w});
}

double vmf_length(double kappa) {
    return 1.0 / std::tanh(kappa) - 1.0 / kappa;
}

/// Length of the mean NDF vector of surfels, weighted by area: what the octree would merge to.
double merged_length(const std::vector<Surfel>& surfels) {
    Vec3d sum;
    double weight = 0.0;
    for (const Surfel& s : surfels) {
        const double area = static_cast<double>(s.radius) * s.radius;
        sum += vec3_cast<double>(s.normal) * (s.ndf_length * area);
        weight += area;
    }
    return length(sum) / weight;
}

TEST(Ndf, LengthOfAVonMisesFisherLobeMatchesItsFormula) {
    for (const double kappa : {0.5, 2.0, 10.0, 50.0, 400.0}) {
        testing::Random random(11);
        std::vector<Vec3f> normals;
        std::vector<float> areas;
        for (int i = 0; i < 100000; ++i) {
            normals.push_back(draw_vmf(random, kappa));
            areas.push_back(static_cast<float>(random.uniform(0.1, 1.0)));
        }
        const double measured = mean_normal_length(normals, areas);
        std::printf("    kappa %.1f: %.5f, formula %.5f\n", kappa, measured, vmf_length(kappa));
        EXPECT_NEAR(measured / vmf_length(kappa), 1.0, 0.01);
    }
}

TEST(Ndf, MeansOfMeansAreTheMean) {
    testing::Random random(5);
    std::vector<Vec3f> all;
    Vec3d merged;
    for (int group = 0; group < 8; ++group) {
        Vec3d sum;
        for (int i = 0; i < 1000; ++i) {
            all.push_back(draw_vmf(random, 20.0));
            sum += vec3_cast<double>(all.back());
        }
        merged += sum / 1000.0 / 8.0;
    }
    const std::vector<float> areas(all.size(), 1.0f);
    EXPECT_NEAR(mean_normal_length(all, areas), length(merged), 1e-5);
}

TEST(Ndf, LengthVarianceAndLobesAgree) {
    for (const float v : {0.0f, 0.001f, 0.05f, 0.4f, 3.0f}) {
        const float l = ndf_length_of(v);
        EXPECT_NEAR(slope_variance_of(l), v, 1e-5f + 1e-3f * v);
        if (v == 0.0f) continue;
        EXPECT_NEAR(blinn_phong_of(l) * v, 1.0f, 1e-2f);
        EXPECT_NEAR(ggx_alpha_of(l), std::min(std::sqrt(2.0f * v), 1.0f), 1e-3f);
    }
    EXPECT_EQ(ndf_length_of(0.0f), 1.0f);
    EXPECT_EQ(ndf_length_of(-1.0f), 1.0f);
    EXPECT_EQ(ggx_alpha_of(1.0f), 0.0f);
    EXPECT_EQ(blinn_phong_of(1.0f), std::numeric_limits<float>::infinity());
    EXPECT_EQ(mean_normal_length({}, {}), 1.0f);
}

TEST(Ndf, AFlatWallUnderNoiseReadsFlat) {
    for (const double spacing : {0.02, 0.01, 0.005, 0.003}) {
        testing::Shape wall = testing::make_wall(20000, spacing * std::sqrt(20000.0));
        testing::add_noise(wall, 0.003);
        SurfaceReport report;
        const SurfelCloud cloud = make_surfels(wall.cloud, {}, &report);
        std::printf(
            "    3 mm noise, a point every %.0f mm: mean %.4f, merged %.4f, noise %.2f mm\n",
            1e3 * spacing, report.mean_ndf_length, merged_length(cloud.surfels),
            1e3 * report.range_noise);
        EXPECT_GE(report.mean_ndf_length, 0.98);
        EXPECT_GE(merged_length(cloud.surfels), 0.98);
    }
}

TEST(Ndf, ARippledWallReadsItsTrueLength) {
    // z = a sin(2 pi x / wave): the mean of the unit normals is E[1 / sqrt(1 + slope²)].
    constexpr double wave = 0.3;
    for (const double amplitude : {0.02, 0.03, 0.05}) {
        for (const double noise : {0.0, 0.003}) {
            testing::Shape wall;
            testing::Random random;
            const double k = 2.0 * std::numbers::pi / wave;
            double truth = 0.0;
            while (wall.normals.size() < 40000) {
                const double x = random.uniform(0.0, 2.1), y = random.uniform(0.0, 2.1);
                const double slope = amplitude * k * std::cos(k * x);
                // Evenly by surface, as a scanner close by sees it.
                const double stretch = std::sqrt(1.0 + slope * slope);
                if (random.uniform(0.0, std::sqrt(1.0 + amplitude * amplitude * k * k)) > stretch)
                    continue;
                const Vec3d normal = normalized(Vec3d{-slope, 0.0, 1.0});
                testing::add_point(wall, {x, y, amplitude * std::sin(k * x)}, normal);
                truth += normal.z;
            }
            truth /= static_cast<double>(wall.normals.size());
            wall.cloud.stations = {testing::station_at({1.5, 1.5, 4.0})};
            testing::add_noise(wall, noise);
            const double measured = merged_length(make_surfels(wall.cloud, {}).surfels);
            std::printf("    slope variance %.3f, noise %.0f mm: %.4f, truth %.4f\n",
                        amplitude * amplitude * k * k / 2.0, 1e3 * noise, measured, truth);
            EXPECT_NEAR(measured / truth, 1.0, 0.05);
        }
    }
}

}  // namespace
}  // namespace glowworm
