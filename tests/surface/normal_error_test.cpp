#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "preprocess/read/read_scans.h"
#include "preprocess/surface/surfel_file.h"
#include "preprocess/surface/surfel_points.h"
#include "preprocess/write/cloud_writer.h"
#include "surface/accuracy.h"
#include "surface/shapes.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::Shape;

double angle_deg(const Surfel& surfel, const Vec3f& truth) {
    const double c = dot(vec3_cast<double>(surfel.normal), vec3_cast<double>(truth));
    return std::acos(std::min(std::abs(c), 1.0)) * 180.0 / std::numbers::pi;
}

TEST(NormalErrors, AreTheRootMeanSquareOfTheTrueOnes) {
    for (const bool grow : {false, true}) {
        Shape wall = testing::make_wall(20000, 2.0);
        testing::add_noise(wall, 0.003);
        SurfaceSettings settings;
        if (!grow) settings.max_k = settings.k;
        std::vector<float> errors;
        const SurfelCloud cloud = make_surfels(wall.cloud, settings, nullptr, {}, &errors);
        ASSERT_EQ(errors.size(), cloud.surfels.size());
        const std::vector<Vec3f> truth = testing::truth_of(cloud.surfels, wall);
        double said = 0.0, true_ones = 0.0;
        for (std::size_t i = 0; i < errors.size(); ++i) {
            said += errors[i] * errors[i];
            true_ones += std::pow(angle_deg(cloud.surfels[i], truth[i]), 2);
        }
        const double ratio = std::sqrt(said / true_ones);
        std::printf("    stated / true %.3f\n", ratio);
        EXPECT_NEAR(ratio, 1.0, 0.2);
    }
}

TEST(NormalErrors, TellGoodNormalsFromBad) {
    // Of the quarter said to be worst the true error is at least twice that of the best quarter.
    Shape room = testing::make_room(30000);
    testing::add_noise(room, 0.003);
    std::vector<float> errors;
    const SurfelCloud cloud = make_surfels(room.cloud, {}, nullptr, {}, &errors);
    const std::vector<Vec3f> truth = testing::truth_of(cloud.surfels, room);
    std::vector<std::size_t> order(errors.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::ranges::sort(order, {}, [&](std::size_t i) { return errors[i]; });
    double best = 0.0, worst = 0.0;
    for (std::size_t i = 0; i < order.size() / 4; ++i) {
        best += angle_deg(cloud.surfels[order[i]], truth[order[i]]);
        const std::size_t last = order[order.size() - 1 - i];
        worst += angle_deg(cloud.surfels[last], truth[last]);
    }
    std::printf("    mean true error of the worst quarter / of the best %.2f\n", worst / best);
    EXPECT_GT(worst, 2.0 * best);
}

TEST(NormalErrors, LieInTheSurfelsPlyWhereReadersPassThemOver) {
    const testing::ScratchFolder folder;
    Shape room = testing::make_room(3000);
    std::vector<float> errors;
    const SurfelCloud cloud = make_surfels(room.cloud, {}, nullptr, {}, &errors);
    const PointCloud points = to_points(cloud);
    write_cloud(points, folder / "without.ply");
    write_cloud(points, folder / "with.ply", std::vector{ExtraColumn{"normal_error", errors}});
    EXPECT_EQ(std::filesystem::file_size(folder / "with.ply"),
              std::filesystem::file_size(folder / "without.ply") + 4 * errors.size() +
                  std::string_view("property float normal_error\n").size());

    const auto surfels_of = [](const SurfelFile& file) {
        std::vector<Surfel> surfels;
        file.stream.for_each([&](std::span<const Surfel> some) {
            surfels.insert(surfels.end(), some.begin(), some.end());
        });
        return surfels;
    };
    const std::vector<Surfel> with = surfels_of(open_surfels(folder / "with.ply", {}, 0.5f));
    const std::vector<Surfel> without = surfels_of(open_surfels(folder / "without.ply", {}, 0.5f));
    ASSERT_EQ(with.size(), cloud.surfels.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
        EXPECT_EQ(with[i].position, without[i].position);
        EXPECT_EQ(with[i].normal, without[i].normal);
        EXPECT_EQ(with[i].radius, without[i].radius);
        EXPECT_EQ(with[i].station, without[i].station);
    }
}

}  // namespace
}  // namespace glowworm
