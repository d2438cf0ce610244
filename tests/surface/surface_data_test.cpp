#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "preprocess/read/read_scans.h"
#include "preprocess/surface/neighbours.h"
#include "preprocess/surface/surface.h"
#include "surface/accuracy.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::Shape;

/// A lit scene's points with their normals dropped, kept aside as the truth.
Shape scene_points(const std::filesystem::path& scene) {
    Shape shape;
    shape.cloud = read_cloud(scene / "points.ply");
    shape.normals = std::move(shape.cloud.points.normals);
    shape.cloud.points.normals.clear();
    shape.cloud.points.stations.assign(shape.normals.size(), 0);
    return shape;
}

/// Gives every point one of the viewpoints that its front faces, the most squarely near one, and
/// drops the points that face none.
void see_from(Shape& shape, const std::vector<Vec3d>& viewpoints) {
    shape.cloud.stations.clear();
    for (const Vec3d& v : viewpoints)
        shape.cloud.stations.push_back(testing::station_at(v));
    std::vector<std::uint32_t> seen;
    std::vector<Vec3f> normals;
    for (std::size_t i = 0; i < shape.normals.size(); ++i) {
        double best = 0.0;
        for (std::size_t v = 0; v < viewpoints.size(); ++v) {
            const Vec3d view = viewpoints[v] - shape.cloud.origin -
                               vec3_cast<double>(shape.cloud.points.positions[i]);
            const double distance = length(view);
            const double cosine = dot(view, vec3_cast<double>(shape.normals[i])) / distance;
            if (cosine < 0.1 || cosine / distance < best) continue;
            best = cosine / distance;
            shape.cloud.points.stations[i] = static_cast<std::uint32_t>(v);
        }
        if (best == 0.0) continue;
        seen.push_back(static_cast<std::uint32_t>(i));
        normals.push_back(shape.normals[i]);
    }
    shape.cloud.points = shape.cloud.points.select(seen);
    shape.normals = std::move(normals);
}

testing::Accuracy measure(const char* what, const Shape& shape) {
    SurfaceReport report;
    const SurfelCloud cloud = make_surfels(shape.cloud, {}, &report);
    const testing::Accuracy accuracy =
        testing::compare(cloud.surfels, testing::truth_of(cloud.surfels, shape));
    testing::print(what, accuracy, report);
    return accuracy;
}

const std::vector<Vec3d> kCavernViews = {
    {4.6, -1.2, -0.3}, {-3.8, 0.8, -0.4}, {3.6, -6.7, -0.6}, {-0.3, -1.9, -0.3}, {3.2, 0.6, 0.7}};

TEST(SurfaceOfRealShapes, NormalsOfTheCavernMatchItsMesh) {
    GLOWWORM_DATA_OR_SKIP(data);
    Shape cavern = scene_points(data / "gi" / "D_cavern");
    see_from(cavern, kCavernViews);
    const testing::Accuracy clean = measure("cavern", cavern);
    EXPECT_LT(clean.median_deg, 3.5);
    EXPECT_GT(clean.right_side, 0.999);
    testing::add_noise(cavern, 0.003);
    const testing::Accuracy noisy = measure("cavern, 3 mm noise", cavern);
    EXPECT_LT(noisy.median_deg, 4.0);
    EXPECT_GT(noisy.right_side, 0.999);
}

TEST(SurfaceOfRealShapes, WithoutStationsTheCavernsStillFaceInward) {
    GLOWWORM_DATA_OR_SKIP(data);
    for (const char* scene : {"C_dogleg", "D_cavern"}) {
        Shape shape = scene_points(data / "gi" / scene);
        shape.cloud.stations = {testing::station_at({0, 0, 0}, false)};
        testing::add_noise(shape, 0.003);
        EXPECT_GT(measure(scene, shape).right_side, 0.99) << scene;
    }
}

TEST(SurfaceOfRealShapes, AMineDriftWithoutAStationBecomesSurfels) {
    GLOWWORM_DATA_OR_SKIP(data);
    PointCloud drift = read_cloud(data / "mine_pcr" / "2025-04-21-11-04-46.pcd");
    for (Station& station : drift.stations)
        station.has_viewpoint = false;
    SurfaceReport report;
    const SurfelCloud cloud = make_surfels(drift, {}, &report);
    std::printf("    %zu surfels of %zu points, noise %.1f mm, spacing %.0f mm, unsure %zu\n",
                report.surfels, report.points, 1e3 * report.range_noise,
                1e3 * report.median_spacing, report.unsure_side);
    EXPECT_EQ(report.orientation, Orientation::kPropagation);
    EXPECT_EQ(report.albedo, AlbedoSource::kIntensities);
    EXPECT_GT(cloud.surfels.size(), report.points * 98 / 100);
}

}  // namespace
}  // namespace glowworm
