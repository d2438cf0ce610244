#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>

#include "preprocess/surface/disc_cast.h"
#include "preprocess/surface/normal_patches.h"
#include "surface/shapes.h"

namespace glowworm {
namespace {

TEST(JoinPatches, TheLoudestLinkDecidesAndLinksAddUp) {
    // 0 and 1 agree loudly; each says quietly that 2 is opposite, which together outweighs 3.
    const std::vector<PatchLink> links = sum_links(
        {{0, 1, 9.0f}, {0, 2, -2.0f}, {2, 1, -2.0f}, {2, 3, 3.0f}, {0, 3, 1.0f}, {1, 0, 1.0f}});
    EXPECT_EQ(links.size(), 5u);
    EXPECT_EQ(links[0].agreement, 10.0f);
    const auto of = join_patches(5, links);
    const auto opposite = [&](std::size_t a, std::size_t b) { return (of[a] ^ of[b]) & 1; };
    for (std::size_t p = 1; p < 4; ++p)
        EXPECT_EQ(of[p] >> 1, of[0] >> 1);
    EXPECT_FALSE(opposite(0, 1));
    EXPECT_TRUE(opposite(0, 2));
    EXPECT_FALSE(opposite(2, 3));
    EXPECT_NE(of[4] >> 1, of[0] >> 1);
    EXPECT_TRUE(join_patches(0, {}).empty());
}

TEST(DiscCast, RaysEndOnTheSphereThatTheyAreIn) {
    const testing::Shape sphere = testing::make_sphere(20000, 2.0);
    SurfacePoints points;
    points.tree = make_point_tree(sphere.cloud.points.positions);
    NeighbourTable table{12, {}};
    const auto planes = fit_local_planes(points, {}, table, {});
    const DiscCast cast(points, planes);
    testing::Random random(4);
    int lost = 0;
    double worst = 0.0;
    for (int r = 0; r < 2000; ++r) {
        const Vec3f from = vec3_cast<float>(random.direction() * 0.5);
        const Vec3f direction = vec3_cast<float>(random.direction());
        const DiscCast::Hit hit = cast.first(from, direction, 0.0f, 100.0f);
        if (hit.point == kNoNeighbour) {
            ++lost;
            continue;
        }
        // A chord from within: |from + t direction| = 2.
        const double b = dot(from, direction), c = dot(from, from) - 4.0;
        worst = std::max(worst, std::abs(hit.distance - (std::sqrt(b * b - c) - b)));
        EXPECT_EQ(cast.first(from, direction, 0.0f, hit.distance * 0.9f).point, kNoNeighbour);
    }
    std::printf("    %d of 2000 rays lost, worst distance off by %.2f mm\n", lost, 1e3 * worst);
    EXPECT_LT(lost, 60);
    EXPECT_LT(worst, 0.005);
    EXPECT_EQ(cast.first({5, 5, 5}, {0, 0, 1}, 0.0f, 100.0f).point, kNoNeighbour);
}

}  // namespace
}  // namespace glowworm
