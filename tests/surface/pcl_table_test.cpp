#include <gtest/gtest.h>

#include <cstdio>

#include "surface/accuracy.h"
#include "surface/pcl_normals.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

using testing::Accuracy;
using testing::Shape;

constexpr int kNeighbours = 16;

std::vector<Surfel> pcl_surfels(const Shape& shape) {
    const std::vector<Vec3f>& positions = shape.cloud.points.positions;
    const std::vector<Vec3f> normals = testing::pcl_normals(positions, kNeighbours, 1);
    std::vector<Surfel> surfels(positions.size());
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        surfels[i].position = positions[i];
        surfels[i].normal = normals[i];
    }
    return surfels;
}

std::vector<Surfel> our_surfels(const Shape& shape, bool grow, bool sharp) {
    SurfaceSettings settings;
    settings.k = kNeighbours;
    if (!grow) settings.max_k = kNeighbours;
    settings.sharp_edges = sharp;
    return make_surfels(shape.cloud, settings).surfels;
}

/// How true the normals are where `counts` says so.
template <typename Counts>
Accuracy accuracy_of(const char* what, const std::vector<Surfel>& surfels, const Shape& shape,
                     const Counts& counts) {
    const std::vector<Vec3f> all = testing::truth_of(surfels, shape);
    std::vector<Surfel> asked;
    std::vector<Vec3f> truth;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        if (!counts(surfels[i].position)) continue;
        asked.push_back(surfels[i]);
        truth.push_back(all[i]);
    }
    const Accuracy accuracy = testing::compare(asked, truth);
    std::printf("    %-28s median %5.2f deg, 95 %% %5.2f deg\n", what, accuracy.median_deg,
                accuracy.p95_deg);
    return accuracy;
}

constexpr auto kEverywhere = [](const Vec3f&) { return true; };

/// Within `reach` metres of where two faces of the room meet.
auto near_edges(float reach) {
    return [inner = 1.0f - reach](const Vec3f& p) {
        return (std::abs(p.x) > inner) + (std::abs(p.y) > inner) + (std::abs(p.z) > inner) > 1;
    };
}

TEST(SurfaceAgainstPcl, SmoothShapesWithNoiseAreNotWorseAtEqualNeighbours) {
    // The plain fit is PCL's own to rounding; what the edges and the growth add must not cost.
    for (auto [name, shape] : {std::pair{"wall", testing::make_wall(15000, 2.0)},
                               std::pair{"sphere", testing::make_sphere(40000, 2.0)},
                               std::pair{"tube", testing::make_tube(40000, 1.0, 8.0)},
                               std::pair{"curtain", testing::make_curtain(15000, 0.05)}}) {
        testing::add_noise(shape, 0.003);
        std::printf("  %s\n", name);
        const Accuracy pcl = accuracy_of("PCL", pcl_surfels(shape), shape, kEverywhere);
        const Accuracy plain =
            accuracy_of("k fixed", our_surfels(shape, false, false), shape, kEverywhere);
        const Accuracy sharp =
            accuracy_of("k fixed, edges", our_surfels(shape, false, true), shape, kEverywhere);
        const Accuracy grown =
            accuracy_of("growing, edges", our_surfels(shape, true, true), shape, kEverywhere);
        EXPECT_LE(plain.median_deg, 1.005 * pcl.median_deg) << name;
        EXPECT_LE(plain.p95_deg, 1.005 * pcl.p95_deg) << name;
        EXPECT_LE(sharp.median_deg, 1.005 * pcl.median_deg) << name;
        EXPECT_LE(sharp.p95_deg, 1.005 * pcl.p95_deg) << name;
        EXPECT_LT(grown.median_deg, pcl.median_deg) << name;
        EXPECT_LT(grown.p95_deg, pcl.p95_deg) << name;
    }
}

TEST(SurfaceAgainstPcl, EdgesOfACubeWithNoiseAreBetterAtEqualNeighbours) {
    // Neighbourhoods reach 4.5 cm. Noise of 3 mm takes a point beyond the other face's plane, where
    // nothing tells that it is not of that face, in 0.8 times 3 mm of the strip beside an edge: in
    // 4.8 % of 5 cm. Those get a normal between the two.
    Shape room = testing::make_room(60000);
    testing::add_noise(room, 0.003);
    const std::vector<Surfel> theirs = pcl_surfels(room);
    for (const bool grow : {false, true}) {
        const std::vector<Surfel> ours = our_surfels(room, grow, true);
        const Accuracy pcl = accuracy_of("5 cm, PCL", theirs, room, near_edges(0.05f));
        const Accuracy sharp = accuracy_of("5 cm", ours, room, near_edges(0.05f));
        EXPECT_LT(sharp.median_deg, pcl.median_deg);
        EXPECT_LT(sharp.p95_deg, pcl.p95_deg);
        const Accuracy pcl_wide = accuracy_of("10 cm, PCL", theirs, room, near_edges(0.1f));
        const Accuracy sharp_wide = accuracy_of("10 cm", ours, room, near_edges(0.1f));
        EXPECT_LT(sharp_wide.median_deg, pcl_wide.median_deg);
        EXPECT_LT(sharp_wide.p95_deg, pcl_wide.p95_deg);
    }
}

TEST(SurfaceAgainstPcl, ACurtainThinnerThanTheNeighbourhoodIsBetterAtEqualNeighbours) {
    Shape curtain = testing::make_curtain(1500, 0.05);
    testing::add_noise(curtain, 0.003);
    const Accuracy pcl = accuracy_of("PCL", pcl_surfels(curtain), curtain, kEverywhere);
    const Accuracy ours =
        accuracy_of("k fixed, edges", our_surfels(curtain, false, true), curtain, kEverywhere);
    EXPECT_LT(ours.median_deg, pcl.median_deg);
    EXPECT_LT(ours.p95_deg, pcl.p95_deg);
}

}  // namespace
}  // namespace glowworm
