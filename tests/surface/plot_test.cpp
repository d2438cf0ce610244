#include "preprocess/surface/normal_plan.h"

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
    const Picture picture = plot_surfels(make_surfels(wall.cloud, {}), 100);
    const int middle = kPlanMargin + 50;
    EXPECT_EQ(picture.at(middle, middle), (Rgb8{128, 128, 255}));
    EXPECT_EQ(picture.at(picture.width / 2 + middle, middle), (Rgb8{252, 232, 36}));
    EXPECT_EQ(picture.at(kPlanMargin + 130, middle), picture.at(0, 0)) << "beside the plan";

    const testing::ScratchFolder folder;
    write_png(picture, folder / "plan.png");
    EXPECT_GT(std::filesystem::file_size(folder / "plan.png"), 100u);
}

TEST(Plot, NoSurfelsGiveNoPicture) {
    EXPECT_EQ(plot_surfels({}).width, 0);
    const testing::ScratchFolder folder;
    EXPECT_THROW(write_png(Picture{}, folder / "plan.png"), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "plan.png"));
}

}  // namespace
}  // namespace glowworm
