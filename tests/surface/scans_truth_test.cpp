#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>

#include "preprocess/kd_tree.h"
#include "preprocess/poses.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/surface/surface.h"
#include "testing.h"

namespace glowworm {
namespace {

/// Every third point of the simulated scans at their true poses, without the persons in them.
PointCloud true_merge(const std::filesystem::path& folder) {
    PointCloud cloud;
    for (const ScanPose& pose : read_poses(folder / "poses.json").scans) {
        const std::filesystem::path file = folder / pose.file;
        Scan scan = std::move(read_scans(file).front());
        std::ifstream persons(folder / (file.stem().string() + "_obstacle.txt"));
        std::set<std::uint32_t> left_out;
        for (std::uint32_t i = 0; persons >> i;)
            left_out.insert(i);
        for (std::uint32_t i = 0; i < scan.points.size(); i += 3) {
            if (left_out.contains(i)) continue;
            const Vec3d p = scan.offset + vec3_cast<double>(scan.points.positions[i]);
            const Eigen::Vector3d w = pose.T_world_scan * Eigen::Vector3d(p.x, p.y, p.z);
            cloud.points.positions.push_back(vec3_cast<float>(Vec3d{w.x(), w.y(), w.z()}));
            cloud.points.stations.push_back(static_cast<std::uint32_t>(cloud.stations.size()));
        }
        const Eigen::Vector3d t = pose.T_world_scan.translation();
        cloud.stations.push_back({.position = {t.x(), t.y(), t.z()}, .name = pose.file});
    }
    return cloud;
}

/// Share of the surfels whose normal has the side of the nearest true one; strays, which lie
/// farther than 5 cm from the truth, are not asked.
double right_side(const SurfelCloud& cloud, const PointCloud& truth, const KdTree& tree) {
    std::size_t right = 0, asked = 0;
    for (const Surfel& surfel : cloud.surfels) {
        const Neighbour nearest = tree.nearest(surfel.position, 0.05f);
        if (!nearest.found()) continue;
        ++asked;
        right += dot(truth.points.normals[nearest.index], surfel.normal) > 0.0f;
    }
    EXPECT_GT(asked, cloud.surfels.size() * 99 / 100);
    return static_cast<double>(right) / static_cast<double>(asked);
}

TEST(SurfaceOfScans, NormalsFaceThePassageWithStationsAndWithout) {
    GLOWWORM_DATA_OR_SKIP(data);
    const PointCloud truth = read_cloud(data / "gi" / "D_cavern" / "points.ply");
    const KdTree tree(truth.points.positions);
    PointCloud cloud = true_merge(data / "scans" / "D_cavern");

    SurfaceReport report;
    const double with = right_side(make_surfels(cloud, {}, &report), truth, tree);
    EXPECT_EQ(report.orientation, Orientation::kStations);
    cloud.points.stations.clear();
    cloud.stations = {{.position = {}, .has_viewpoint = false}};
    const double without = right_side(make_surfels(cloud, {}, &report), truth, tree);
    EXPECT_EQ(report.orientation, Orientation::kPropagation);
    std::printf("    right side with stations %.3f %%, without %.3f %%\n", 100 * with,
                100 * without);
    EXPECT_GE(with, 0.999);
    EXPECT_GE(without, 0.99);
}

}  // namespace
}  // namespace glowworm
