#include <gmock/gmock.h>

#include <gtest/gtest.h>
#include <iostream>

#include <cmath>

#include "camera_at.h"
#include "lit_room.h"
#include "viewer/frame/frame.h"
#include "viewer/frame/inspector.h"

namespace glowworm {
namespace {

using testing::LitRoom;

constexpr int kWidth = 96, kHeight = 72;

/// From outside through the +x wall into the room.
View from_outside() {
    return view_of(testing::camera_at({6.0, 0.2, 1.2}, {0.0, 0.2, 1.2}, 40.0, kWidth, kHeight));
}

/// From within, at the far wall.
View across() {
    return view_of(testing::camera_at({-1.0, 0.0, 1.2}, {2.0, 0.0, 1.2}, 60.0, kWidth, kHeight));
}

TEST(ClipBox, DrawsWhatLiesInItAndNothingElse) {
    LitRoom room;
    View view = from_outside();
    view.clip = WorldBox{{-1.0, -0.8, 0.5}, {1.0, 0.8, 3.0}};
    const FrameLayers layers = room.frame.render(view, room.light);
    int inside = 0, lit = 0, outside = 0;
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const auto pixel = static_cast<std::size_t>(y * kWidth + x);
            if (layers.depth[pixel] <= 0.0f) continue;
            const ViewRay ray = ray_through(view, x + 0.5, y + 0.5);
            const Vec3d point = ray.origin + ray.direction * double{layers.depth[pixel]};
            bool in = true;
            for (int axis = 0; axis < 3; ++axis) {
                // A disc whose centre lies inside reaches over the side by its radius.
                in = in && point[axis] > view.clip->low[axis] - 0.1 &&
                     point[axis] < view.clip->high[axis] + 0.1;
            }
            (in ? inside : outside) += 1;
            lit += in && layers.direct[pixel].x > 0.0f ? 1 : 0;
        }
    }
    std::cout << inside << " pixels in the box, " << lit << " lit by the lamp, " << outside
              << " outside\n";
    EXPECT_EQ(outside, 0);
    EXPECT_GT(inside, 20) << "the ceiling's underside, seen at a slant";
    EXPECT_EQ(lit, inside) << "light is that of the whole room";

    view.clip.reset();
    const FrameLayers whole = room.frame.render(view, room.light);
    const auto drawn = kWidth * kHeight - std::ranges::count(whole.depth, 0.0f);
    EXPECT_GT(drawn, 4 * inside) << "the far wall, floor and ceiling";
}

TEST(Inspector, ShowsPointsWithoutLightWhereSurfacesAreAllThereIs) {
    LitRoom room;
    room.frame.draw_surfaces(across(), Frame::Missing::kWaitFor);
    Inspector inspector;
    const Texture target("target", GL_RGBA8, kWidth, kHeight);
    inspector.draw(room.frame, nullptr, {Layer::kUnlit, 0, 0.0, ToneCurve::kLinear}, target);
    std::vector<std::uint32_t> pixels(kWidth * kHeight);
    glGetTextureImage(target.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                      static_cast<GLsizei>(pixels.size() * 4), pixels.data());
    const auto red = [&](int x, int y) { return int(pixels[std::size_t(y * kWidth + x)] & 255u); };
    std::cout << "a wall face on " << red(kWidth / 2, kHeight / 2) << ", along the sight "
              << red(2, kHeight / 2) << "\n";
    EXPECT_GT(red(kWidth / 2, kHeight / 2), red(2, kHeight / 2) + 20);
    EXPECT_GT(red(2, kHeight / 2), 0);
    EXPECT_THAT(room.context.errors(), ::testing::IsEmpty());
}

TEST(Inspector, ShowsTheCellsOfALevelAndWhatTheyRadiate) {
    LitRoom room;
    room.frame.draw(across(), room.light, Frame::Missing::kWaitFor);
    Inspector inspector;
    const Texture target("target", GL_RGBA8, kWidth, kHeight);
    const auto colours_of = [&](Layer layer, int level) {
        inspector.draw(room.frame, &room.light, {layer, level, 0.0, ToneCurve::kLinear}, target);
        std::vector<std::uint32_t> pixels(kWidth * kHeight);
        glGetTextureImage(target.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE,
                          static_cast<GLsizei>(pixels.size() * 4), pixels.data());
        return pixels;
    };
    const auto kinds = [](std::vector<std::uint32_t> pixels) {
        std::ranges::sort(pixels);
        return std::unique(pixels.begin(), pixels.end()) - pixels.begin();
    };
    // Eight cells at the first level, of which a look along +x meets at most all; 12.5 cm at the
    // last, of which the far wall alone shows hundreds.
    EXPECT_EQ(kinds(colours_of(Layer::kVoxels, 0)), 1);
    EXPECT_LE(kinds(colours_of(Layer::kVoxels, 1)), 8);
    EXPECT_GT(kinds(colours_of(Layer::kVoxels, 5)), 200);

    const auto red = [](std::uint32_t pixel) { return int(pixel & 255u); };
    const auto opacity = colours_of(Layer::kOpacity, 5), radiance = colours_of(Layer::kRadiance, 5);
    const std::size_t middle = kHeight / 2 * kWidth + kWidth / 2;
    EXPECT_GT(red(opacity[middle]), 240) << "a wall seen face on";
    EXPECT_GT(red(radiance[middle]), 10) << "lit by the lamp";
    EXPECT_THAT(room.context.errors(), ::testing::IsEmpty());
}

}  // namespace
}  // namespace glowworm
