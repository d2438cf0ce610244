#include "viewer/frame/occlusion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <random>

#include "analytic_cave.h"
#include "camera_at.h"
#include "octree/build.h"
#include "octree/chunk.h"

namespace glowworm {
namespace {

constexpr float kNothing = std::numeric_limits<float>::infinity();

View view_to_the_north() {
    return view_of(testing::camera_at({0, 0, 0}, {0, 1, 0}, 90.0, 80, 64));
}

bool hidden(const DepthPyramid& pyramid, const Vec3d& middle, double radius = 0.01) {
    return is_hidden(pyramid, view_to_the_north(), {}, {middle, {0.5, 0.5, 0.5}}, radius);
}

TEST(DepthPyramid, NeverSaysNearerThanAnyPixelOfTheRectangle) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> depth(1.0f, 100.0f);
    constexpr int kColumns = 11, kRows = 7;
    std::vector<float> tiles(kColumns * kRows);
    for (float& tile : tiles)
        tile = depth(random);
    const DepthPyramid pyramid(tiles, kColumns, kRows, 8);
    std::uniform_real_distribution<double> x(-20.0, 108.0), y(-20.0, 76.0);
    double loose = 0;
    for (int i = 0; i < 2000; ++i) {
        const auto [left, right] = std::minmax({x(random), x(random)});
        const auto [top, bottom] = std::minmax({y(random), y(random)});
        float truth = 0.0f;
        for (int row = 0; row < kRows; ++row) {
            for (int column = 0; column < kColumns; ++column) {
                if (right >= 8 * column && left < 8 * column + 8 && bottom >= 8 * row &&
                    top < 8 * row + 8) {
                    truth = std::max(truth, tiles[std::size_t(row * kColumns + column)]);
                }
            }
        }
        const float farthest = pyramid.farthest(left, top, right, bottom);
        ASSERT_GE(farthest, truth) << left << ".." << right << ", " << top << ".." << bottom;
        loose += farthest > truth ? 1 : 0;
    }
    EXPECT_LT(loose, 2000) << "not always farther";
    EXPECT_EQ(pyramid.farthest(200, 0, 220, 10), kNothing) << "outside of the picture";
}

TEST(DepthPyramid, HidesWhatLiesBehindAWallAndNothingElse) {
    const DepthPyramid wall(std::vector<float>(80, 5.0f), 10, 8, 8);  // 5 m ahead everywhere
    EXPECT_TRUE(hidden(wall, {0, 8, 0}));
    EXPECT_TRUE(hidden(wall, {6, 8, 0})) << "in the picture in part";
    EXPECT_FALSE(hidden(wall, {0, 3, 0})) << "before it";
    EXPECT_FALSE(hidden(wall, {0, 5.2, 0})) << "across it";
    EXPECT_FALSE(hidden(wall, {0, 5.515, 0})) << "its discs may be a part of the wall's surface";
    EXPECT_TRUE(hidden(wall, {0, 6, 0}));
    EXPECT_FALSE(hidden(wall, {0, 6, 0}, 0.6)) << "discs of 60 cm";
    EXPECT_FALSE(hidden(wall, {0.3, 0.2, 0})) << "around the eye";

    std::vector<float> gap(80, 5.0f);
    gap[4 * 10 + 5] = kNothing;  // right of the middle, below it
    const DepthPyramid holed(gap, 10, 8, 8);
    EXPECT_FALSE(hidden(holed, {0, 8, 0})) << "seen through the hole";
    EXPECT_TRUE(hidden(holed, {-6, 8, 3}));
}

TEST(DepthPyramid, LooksAsFarRoundASquareAsDiscsThereAreWide) {
    std::vector<float> post(80, 9.0f);
    for (int row = 0; row < 8; ++row) {
        for (int column = 2; column < 9; ++column)
            post[static_cast<std::size_t>(row * 10 + column)] = 1.0f;  // 28 pixels to either side
    }
    const DepthPyramid narrow(post, 10, 8, 8);
    std::vector<std::uint32_t> widths(6, 10u);  // of squares of 32 pixels
    const DepthPyramid wider(post, 10, 8, 8, widths);
    widths.assign(6, 40u);
    const DepthPyramid wide(post, 10, 8, 8, widths);
    const auto hides_a_pebble = [](const DepthPyramid& pyramid) {
        return is_hidden(pyramid, view_to_the_north(), {}, {{0.5, 5, 0}, {0.05, 0.05, 0.05}}, 0.01);
    };
    EXPECT_TRUE(hides_a_pebble(narrow));
    EXPECT_TRUE(hides_a_pebble(wider));
    EXPECT_FALSE(hides_a_pebble(wide)) << "all of the post may be the outer parts of discs";
}

TEST(ChunkBoxes, HoldEverySurfelAndLittleElse) {
    SurfelCloud cloud = testing::dogleg(0.012f);  // more than two chunks' worth
    const Octree octree = build_octree(cloud, {.depth = 5});
    const std::vector<ChunkBox> boxes = chunk_boxes(octree.view());
    ASSERT_EQ(boxes.size(), octree.chunks.size());
    ASSERT_GT(boxes.size(), 2u);
    double volume = 0, cells = 0;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
        const Chunk& chunk = octree.chunks[i];
        for (std::uint32_t k = 0; k < chunk.count; ++k) {
            const Surfel surfel = unpack_surfel(chunk, octree.surfels[chunk.first + k]);
            const Vec3d off = vec3_cast<double>(surfel.position) - boxes[i].centre;
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_LE(std::abs(off[axis]), boxes[i].half[axis] + 1e-6) << i << " " << k;
        }
        volume += 8 * boxes[i].half.x * boxes[i].half.y * boxes[i].half.z;
        cells += std::pow(chunk.box_edge, 3);
    }
    std::cout << "boxes take " << volume / cells << " of the cells that positions count from\n";
    EXPECT_LT(volume, 0.5 * cells);
}

}  // namespace
}  // namespace glowworm
