#include "preprocess/surface/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "octree/error.h"
#include "surface/accuracy.h"
#include "surface/shapes.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::Shape;

std::filesystem::path written(const testing::ScratchFolder& folder, const std::string& text) {
    std::ofstream(folder / "trajectory.txt") << text;
    return folder / "trajectory.txt";
}

/// Bends left and right, so that no single place sees it all.
Shape make_walked_tube() {
    Shape shape;
    testing::Random random;
    for (int i = 0; i < 60000; ++i) {
        const double s = random.uniform(0, 20), phi = random.uniform(0, 2 * std::numbers::pi);
        const Vec3d d{0, std::cos(phi), std::sin(phi)};
        testing::add_point(shape, Vec3d{s, 3 * std::sin(s / 3), 0} + d, -d);
    }
    testing::add_noise(shape, 0.003);
    shape.cloud.stations = {testing::station_at({}, false)};
    return shape;
}

Trajectory walk(bool with_times) {
    Trajectory trajectory;
    for (double s = 0.0; s <= 20.0; s += 0.1) {
        trajectory.positions.push_back({s, 3 * std::sin(s / 3), 0});
        if (with_times) trajectory.times.push_back(1000.0 + s);
    }
    return trajectory;
}

double right_side(const Shape& shape, const Trajectory& trajectory, SurfaceReport& report) {
    SurfaceSettings settings;
    settings.trajectory = trajectory;
    const SurfelCloud cloud = make_surfels(shape.cloud, settings, &report);
    const testing::Accuracy accuracy =
        testing::compare(cloud.surfels, testing::truth_of(cloud.surfels, shape));
    testing::print("walked tube", accuracy, report);
    return accuracy.right_side;
}

TEST(Trajectory, IsReadWithTimesAndWithout) {
    const testing::ScratchFolder folder;
    const Trajectory timed =
        read_trajectory(written(folder, "# TUM\n2.5 1 2 3 0 0 0 1\n\n1.5 4 5 6 0 0 0 1\r\n"));
    EXPECT_THAT(timed.times, ::testing::ElementsAre(1.5, 2.5));
    EXPECT_EQ(timed.positions[0], (Vec3d{4, 5, 6}));
    const Trajectory plain = read_trajectory(written(folder, "x,y,z\n1,2,3\n4;5; 6\n"));
    EXPECT_TRUE(plain.times.empty());
    EXPECT_EQ(plain.positions[1], (Vec3d{4, 5, 6}));
}

TEST(Trajectory, WhatIsNoneIsSaidInASentence) {
    const testing::ScratchFolder folder;
    const auto code_of = [&](const std::string& text) {
        try {
            read_trajectory(written(folder, text));
        } catch (const Error& error) {
            std::printf("    %s\n", error.what());
            return error.code();
        }
        return ExitCode::kDone;
    };
    EXPECT_EQ(code_of(""), ExitCode::kDegenerate);
    EXPECT_EQ(code_of("x y z\n"), ExitCode::kDegenerate);
    EXPECT_EQ(code_of("1 2\n"), ExitCode::kUnreadable);
    EXPECT_EQ(code_of("1 2 3\n1 2 nan\n"), ExitCode::kUnreadable);
    EXPECT_EQ(code_of("1 2 3\n1 2 3 4\n"), ExitCode::kUnreadable);
    for (const std::filesystem::path& path : {folder / "none.txt", folder.path()}) {
        try {
            read_trajectory(path);
            ADD_FAILURE() << path << " was read";
        } catch (const Error& error) {
            std::printf("    %s\n", error.what());
            EXPECT_EQ(error.code(), ExitCode::kUnreadable);
        }
    }
}

TEST(Trajectory, NormalsFaceThePoseAtTheirTimeOrTheNearestThatSeesThem) {
    Shape shape = make_walked_tube();
    SurfaceReport report;
    EXPECT_GT(right_side(shape, walk(false), report), 0.999);
    EXPECT_GT(report.seen_from_trajectory, report.surfels * 99 / 100);
    for (const Vec3f& p : shape.cloud.points.positions)
        shape.cloud.points.times.push_back(1000.0 + p.x);
    EXPECT_EQ(right_side(shape, walk(true), report), 1.0);
    EXPECT_EQ(report.seen_from_trajectory, report.surfels);
    EXPECT_EQ(report.orientation, Orientation::kTrajectory);
}

TEST(Trajectory, ACloudThatNamesNoStationsIsNotSeenFromTheFirstPoseAlone) {
    Shape shape = make_walked_tube();
    shape.cloud.stations.clear();
    shape.cloud.points.stations.clear();
    SurfaceReport report;
    EXPECT_GT(right_side(shape, walk(false), report), 0.999);
    EXPECT_GT(report.seen_from_trajectory, report.surfels * 99 / 100);
}

TEST(Trajectory, AWallFacesTheSideThatItWasWalkedOn) {
    // Nothing but the trajectory tells: the wall has no inside, and its free side is downward.
    Shape wall = testing::make_wall(10000, 2.0);
    wall.cloud.stations = {testing::station_at({}, false)};
    for (Vec3f& normal : wall.normals)
        normal = -normal;
    SurfaceReport report;
    EXPECT_EQ(right_side(wall, {{{0.5, 0.5, -1.0}, {1.5, 1.0, -1.2}}, {}}, report), 1.0);
}

TEST(Trajectory, AScanInItsOwnFrameFacesTheOriginThatAllItsPointsSee) {
    // An open shell that bulges toward the scanner: its hollow side is the hidden one.
    Shape shell;
    testing::Random random;
    while (shell.normals.size() < 20000) {
        const Vec3d d = random.direction();
        if (d.x < 0.5) continue;
        testing::add_point(shell, Vec3d{-5, 0, 0} + d * 2.0, d);
    }
    testing::add_noise(shell, 0.003);
    shell.cloud.stations = {testing::station_at({}, false)};
    SurfaceReport report;
    EXPECT_EQ(right_side(shell, {}, report), 1.0);
    EXPECT_EQ(report.orientation, Orientation::kOrigin);
}

}  // namespace
}  // namespace glowworm
