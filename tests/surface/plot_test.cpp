#include "preprocess/surface/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "octree/error.h"
#include "preprocess/surface/surface.h"
#include "surface/shapes.h"
#include "testing.h"

namespace glowworm {
namespace {

TEST(Plot, AFloorIsDrawnInItsNormalsColourAndAsFlat) {
    const testing::Shape wall = testing::make_wall(20000, 1.0);
    const PlanView view = plot_surfels(make_surfels(wall.cloud, {}), 100);
    ASSERT_NEAR(view.width, 200, 2);
    ASSERT_NEAR(view.height, 100, 1);
    const auto pixel = [&](int x, int y) {
        const std::size_t at = static_cast<std::size_t>(y * view.width + x) * 3;
        return std::vector<int>{view.pixels[at], view.pixels[at + 1], view.pixels[at + 2]};
    };
    EXPECT_THAT(pixel(50, 50), ::testing::ElementsAre(128, 128, 255));
    EXPECT_THAT(pixel(view.width / 2 + 50, 50), ::testing::ElementsAre(252, 232, 36));

    const testing::ScratchFolder folder;
    write_png(view, folder / "plan.png");
    EXPECT_GT(std::filesystem::file_size(folder / "plan.png"), 100u);
}

TEST(Plot, NoSurfelsGiveNoPicture) {
    EXPECT_EQ(plot_surfels({}).width, 0);
    const testing::ScratchFolder folder;
    EXPECT_THROW(write_png({}, folder / "plan.png"), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "plan.png"));
}

}  // namespace
}  // namespace glowworm
