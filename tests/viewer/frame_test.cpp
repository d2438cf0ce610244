#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <random>

#include "camera_at.h"
#include "lit_room.h"
#include "viewer/frame/display.h"
#include "viewer/frame/exr.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

using ::testing::IsEmpty;
using testing::LitRoom;

Camera camera_at(const Vec3d& position, const Vec3d& look_at, int width, int height) {
    return testing::camera_at(position, look_at, 70.0, width, height);
}

/// Depth along the view axis at which a ray from inside leaves the room.
double room_depth(const ViewRay& ray) {
    double nearest = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        const double wall =
            ray.direction[axis] > 0 ? testing::kRoomHigh[axis] : testing::kRoomLow[axis];
        const double t = (wall - ray.origin[axis]) / ray.direction[axis];
        if (t > 0) nearest = std::min(nearest, t);
    }
    return nearest;
}

TEST(Frame, LeavesNoHoleInAClosedRoomSeenFromTwentyPlaces) {
    LitRoom room;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> x(-1.8, 1.8), y(-1.3, 1.3), z(0.2, 2.2), any(-1, 1);
    std::size_t holes = 0, pixels = 0;
    double worst = 0, sum = 0;
    for (int i = 0; i < 20; ++i) {
        const Vec3d eye{x(random), y(random), z(random)};
        const Vec3d ahead = normalized(Vec3d{any(random), any(random), any(random)});
        const View view = view_of(camera_at(eye, eye + ahead, 96, 72));
        const FrameLayers layers = room.frame.render(view, room.light);
        for (int py = 0; py < 72; ++py) {
            for (int px = 0; px < 96; ++px) {
                const float depth = layers.depth[static_cast<std::size_t>(py * 96 + px)];
                ++pixels;
                if (depth <= 0) {
                    ++holes;
                    continue;
                }
                const double truth = room_depth(ray_through(view, px + 0.5, py + 0.5));
                worst = std::max(worst, std::abs(depth - truth));
                sum += std::abs(depth - truth);
            }
        }
    }
    std::cout << holes << " holes in " << pixels << " pixels; depth error mean "
              << 1e3 * sum / double(pixels) << " mm, worst " << 1e3 * worst << " mm\n";
    EXPECT_EQ(holes, 0u);
    EXPECT_LT(sum / double(pixels), 0.001) << "m";
    EXPECT_LT(worst, 0.08) << "m: two spacings, in the corners";
    EXPECT_THAT(room.context.errors(), IsEmpty());
}

TEST(Frame, LeavesNoHoleInAVeryWideView) {
    LitRoom room;
    Camera camera = camera_at({-1.7, 0.2, 1.1}, {2.0, 0.0, 1.0}, 96, 72);
    camera.vfov_deg = 165.0;
    const FrameLayers layers = room.frame.render(view_of(camera), room.light);
    const auto holes = std::count(layers.depth.begin(), layers.depth.end(), 0.0f);
    EXPECT_EQ(holes, 0) << "of " << layers.depth.size() << " pixels";
}

TEST(Frame, ShadesALambertianWallByTheFormula) {
    LitRoom room;
    // Straight at the floor, where nothing is in the lamp's way.
    const View view = view_of(camera_at({0, 0, 2.0}, {0, 0.001, 0}, 64, 48));
    const FrameLayers layers = room.frame.render(view, room.light);
    double worst = 0;
    for (int py = 0; py < 48; ++py) {
        for (int px = 0; px < 64; ++px) {
            const ViewRay ray = ray_through(view, px + 0.5, py + 0.5);
            const Vec3d floor = ray.origin + ray.direction * (-ray.origin.z / ray.direction.z);
            if (std::abs(floor.x) > 1.8 || std::abs(floor.y) > 1.3) continue;
            const Vec3d to_lamp = Vec3d{0.5, 0.3, 1.4} - floor;
            const double d2 = dot(to_lamp, to_lamp);
            const double truth = 0.5 / M_PI * 3.0 * to_lamp.z / std::sqrt(d2) / d2;
            const double drawn = layers.direct[static_cast<std::size_t>(py * 64 + px)].x;
            worst = std::max(worst, std::abs(drawn / truth - 1.0));
        }
    }
    std::cout << "worst relative error " << worst << "\n";
    EXPECT_LT(worst, 0.02);
}

TEST(Frame, IsBlackRoundABendUntilLightIsReflected) {
    const Context context = Context::headless();
    const Octree octree = build_octree(testing::dogleg(0.04f), {.depth = 6});
    const Scene scene{{{"lamp", {0.5, 0.5, 0.5}, {3, 3, 3}}}, {}, {}, {}};
    LightField light(context, octree.view(), scene);
    Frame frame(context, octree.view(), {.selection = {}, .samples = 1});
    const View view = view_of(camera_at({3.5, 2.4, 0.5}, {3.5, 4.0, 0.5}, 64, 48));

    const auto brightness = [&] {
        const FrameLayers layers = frame.render(view, light);
        double sum = 0;
        for (std::size_t i = 0; i < layers.depth.size(); ++i)
            sum += layers.beauty(i).x;
        return sum / double(layers.depth.size());
    };
    EXPECT_EQ(brightness(), 0.0) << "no lamp is in sight";
    light.iterate(4);
    const double after_four = brightness();
    light.converge();
    const double settled = brightness();
    std::cout << "mean radiance after 4 bounces " << after_four << ", settled " << settled << "\n";
    EXPECT_GT(after_four, 1e-4);
    EXPECT_GT(settled, after_four);
    EXPECT_THAT(context.errors(), IsEmpty());
}

TEST(Frame, GivesTheSameBytesTwice) {
    LitRoom room;
    const View view = view_of(camera_at({1, -1, 1}, {-1, 1, 0.8}, 80, 60));
    const std::string once = encode_exr(room.frame.render(view, room.light), view);
    EXPECT_EQ(once, encode_exr(room.frame.render(view, room.light), view));

    Frame another(room.context, room.octree.view(), {.selection = {}, .samples = 1});
    EXPECT_EQ(once, encode_exr(another.render(view, room.light), view)) << "from fresh buffers";
}

TEST(Frame, ShowsAnAreaLightAsTheRectangleItIs) {
    LitRoom room;
    // On the wall at y = 1.5, facing the room, 0.6 m wide and 0.4 m high.
    const AreaLight panel{
        "panel",
        {{0.3, 1.45, 1.4}, {-0.3, 1.45, 1.4}, {-0.3, 1.45, 1.0}, {0.3, 1.45, 1.0}},
        {7, 5, 3}};
    ASSERT_LT(panel.normal().y, 0) << "into the room";
    room.frame.set_panels(std::vector<AreaLight>{panel});
    const View view = view_of(camera_at({0, -1, 1.2}, {0, 1, 1.2}, 160, 120));
    const FrameLayers layers = room.frame.render(view, room.light);
    double area = 0;
    for (std::size_t i = 0; i < layers.depth.size(); ++i) {
        if (layers.emission[i].x == 0) continue;
        EXPECT_EQ(layers.emission[i], (Vec3f{7, 5, 3}));
        EXPECT_EQ(layers.direct[i], (Vec3f{})) << "it reflects nothing";
        area += layers.depth[i] * layers.depth[i] / (view.focal * view.focal);
    }
    EXPECT_NEAR(area, 0.6 * 0.4, 0.02) << "m2";
}

TEST(Frame, LeavesNoHoleWhereMemoryHoldsATenthOfTheCloud) {
    LitRoom room;
    const std::size_t tenth = room.octree.view().surfels.size_bytes() / 10;
    Frame coarse(room.context, room.octree.view(),
                 {.selection = {}, .point_memory = tenth, .samples = 1});
    const View view = view_of(camera_at({1, -1, 1}, {-1, 1, 0.8}, 80, 60));
    const FrameLayers fine = room.frame.render(view, room.light);
    const FrameLayers thin = coarse.render(view, room.light);
    EXPECT_LE(coarse.surfels_drawn(), room.frame.surfels_drawn() / 10 + room.octree.chunks.size());
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < fine.depth.size(); ++i) {
        EXPECT_GT(thin.depth[i], 0.0f);
        difference += std::abs(fine.direct[i].x - thin.direct[i].x);
        sum += fine.direct[i].x;
    }
    std::cout << "relative difference of direct light " << difference / sum << "\n";
    EXPECT_LT(difference / sum, 0.05);
}

TEST(Frame, AveragesSubPixelsAtSilhouettes) {
    LitRoom room;
    Frame smooth(room.context, room.octree.view(), {.selection = {}, .samples = 3});
    const View view = view_of(camera_at({0, -1, 1.2}, {0.4, 1, 1.0}, 48, 36));
    const FrameLayers fine = smooth.render(view, room.light);
    const FrameLayers coarse = room.frame.render(view, room.light);
    double difference = 0, sum = 0;
    for (std::size_t i = 0; i < fine.depth.size(); ++i) {
        difference += std::abs(fine.direct[i].x - coarse.direct[i].x);
        sum += coarse.direct[i].x;
    }
    EXPECT_LT(difference / sum, 0.02) << "the same light, but for its edges";
}

TEST(Display, KeepsBlackBlackAndOrdersGreysWithEveryCurve) {
    const Context context = Context::headless();
    Display display;
    FrameLayers ramp(64, 1);
    for (std::size_t i = 0; i < 64; ++i) {
        const float grey = static_cast<float>(i) * static_cast<float>(i) / 1000.0f;
        ramp.direct[i] = {grey, grey, grey};
        ramp.depth[i] = 1;
    }
    for (const ToneCurve curve :
         {ToneCurve::kLinear, ToneCurve::kReinhard, ToneCurve::kAces, ToneCurve::kAgx}) {
        const Picture picture = display.picture_of(ramp, 0.0, curve);
        ASSERT_EQ(picture.rgb.size(), 64u * 3);
        EXPECT_LE(picture.rgb[0], 1);
        for (std::size_t i = 1; i < 64; ++i) {
            EXPECT_GE(picture.rgb[3 * i], picture.rgb[3 * i - 3]) << static_cast<int>(curve);
            EXPECT_NEAR(picture.rgb[3 * i], picture.rgb[3 * i + 2], 2) << "grey stays grey";
        }
    }
    const Picture linear = display.picture_of(ramp, -1.0, ToneCurve::kLinear);
    // 0.4 · 0.5 in sRGB is 0.4845.
    EXPECT_EQ(linear.rgb[3 * 20], 124) << "sRGB of half of 0.4";
    EXPECT_THAT(context.errors(), IsEmpty());
}

}  // namespace
}  // namespace glowworm
