// Lamps and wet walls in a frame, against formulas.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "analytic_cave.h"
#include "camera_at.h"
#include "octree/build.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

Camera camera_at(const Vec3d& position, const Vec3d& look_at, int width, int height) {
    return testing::camera_at(position, look_at, 70.0, width, height);
}

void expect_no_errors(const Context& context) {
    for (const std::string& error : context.errors())
        ADD_FAILURE() << error;
}

struct Room {
    Context context = Context::headless();
    Octree octree = build_octree(
        testing::closed_room({-2.0f, -1.5f, 0.0f}, {2.0f, 1.5f, 2.4f}, 0.04f), {.depth = 5});
    View view = view_of(camera_at({-0.8, -0.4, 1.9}, {-0.1, 0.1, 0.0}, 48, 36));

    FrameLayers render(const Scene& scene, float wetness, int bounces = 0) {
        LightField light(context, octree.view(), scene);
        light.iterate(bounces);
        Frame frame(context, octree.view(), {.selection = {}, .wetness = wetness, .samples = 1});
        return frame.render(view, light);
    }
};

Scene lamps(int count, const Vec3d& place) {
    Scene scene;
    for (int i = 0; i < count; ++i) {
        const float share = 3.0f / static_cast<float>(count);
        scene.point_lights.push_back({"lamp " + std::to_string(i), place, {share, share, share}});
    }
    return scene;
}

TEST(FrameLight, ThreeHundredLampsInOnePlaceAreOneLamp) {
    Room room;
    const FrameLayers one = room.render(lamps(1, {0.5, 0.3, 1.4}), 0.0f);
    const FrameLayers many = room.render(lamps(300, {0.5, 0.3, 1.4}), 0.0f);
    double worst = 0;
    for (std::size_t i = 0; i < one.direct.size(); ++i) {
        if (one.direct[i].x <= 0) continue;
        worst = std::max(worst, std::abs(double(many.direct[i].x / one.direct[i].x) - 1.0));
    }
    std::cout << "worst relative difference " << worst << "\n";
    EXPECT_LT(worst, 1e-4);
    expect_no_errors(room.context);
}

TEST(FrameLight, LobesLookAgainWhereLampsMovedAndRaysAreTracedWhereLooksAreNotKept) {
    const Context context = Context::headless();
    SurfelCloud cloud = testing::closed_room({-2.0f, -1.5f, 0.0f}, {2.0f, 1.5f, 2.4f}, 0.04f);
    const Vec3f low{-0.3f, -0.3f, 1.0f}, high{0.3f, 0.3f, 1.2f};
    testing::add_wall(cloud, 2, low.z, -1.0f, low, high, 0.02f);
    testing::add_wall(cloud, 2, high.z, 1.0f, low, high, 0.02f);
    const Octree octree = build_octree(std::move(cloud), {.depth = 5});
    const View view = view_of(camera_at({-1.6, -1.1, 1.8}, {0.3, 0.2, 0.0}, 96, 72));
    const Scene first = lamps(40, {-0.6, 0.3, 2.0}), moved = lamps(40, {0.5, -0.4, 2.0});
    Frame frame(context, octree.view(), {.samples = 1});

    LightField field(context, octree.view(), first);
    const FrameLayers before = frame.render(view, field);
    field.set_scene(moved);
    const FrameLayers after = frame.render(view, field);
    LightField fresh(context, octree.view(), moved);
    EXPECT_EQ(after.direct, frame.render(view, fresh).direct);
    EXPECT_NE(after.direct, before.direct);

    LightField traced(context, octree.view(), moved, {.memory = 1});
    const FrameLayers exact = frame.render(view, traced);
    EXPECT_EQ(traced.direct().lamp_looks().bytes(), 0u);
    double sum = 0, off = 0;
    for (std::size_t i = 0; i < exact.direct.size(); ++i) {
        sum += exact.direct[i].x;
        off += std::abs(double(after.direct[i].x - exact.direct[i].x));
    }
    std::cout << "looks differ from rays by " << off / sum << " in the mean\n";
    EXPECT_LT(off, 0.005 * sum);
    expect_no_errors(context);
}

TEST(FrameLight, OnlyWetWallsMirrorAndALampShowsWhereAFlatMirrorWouldShowIt) {
    Room room;
    const Vec3d lamp{0.5, 0.3, 1.4};
    const FrameLayers dry = room.render(lamps(1, lamp), 0.0f, 2);
    const FrameLayers wet = room.render(lamps(1, lamp), 1.0f, 2);
    std::size_t brightest = 0;
    for (std::size_t i = 0; i < dry.depth.size(); ++i) {
        EXPECT_EQ(dry.specular[i], (Vec3f{}));
        EXPECT_LE(wet.direct[i].x, dry.direct[i].x) << "what the film mirrors lights no wall";
        EXPECT_LE(wet.indirect[i].x, dry.indirect[i].x);
        if (wet.specular[i].x > wet.specular[brightest].x) brightest = i;
    }
    // The lamp's image lies under the floor, straight below it.
    const PixelPoint image = project(room.view, {lamp.x, lamp.y, -lamp.z});
    const double x = double(brightest % 48) + 0.5, y = double(brightest / 48) + 0.5;
    std::cout << "brightest at " << x << ", " << y << ", the lamp's image at " << image.x << ", "
              << image.y << "\n";
    EXPECT_NEAR(x, image.x, 2.0) << "pixels";
    EXPECT_NEAR(y, image.y, 2.0) << "pixels";
    expect_no_errors(room.context);
}

/// Whether the way from `a` to `b` is clear of the box.
bool passes_by(const Vec3d& a, const Vec3d& b, const Vec3d& low, const Vec3d& high) {
    double enter = 0.0, leave = 1.0;
    for (int axis = 0; axis < 3; ++axis) {
        const double t0 = (low[axis] - a[axis]) / (b[axis] - a[axis] + 1e-12);
        const double t1 = (high[axis] - a[axis]) / (b[axis] - a[axis] + 1e-12);
        enter = std::max(enter, std::min(t0, t1));
        leave = std::min(leave, std::max(t0, t1));
    }
    return enter >= leave;
}

TEST(FrameLight, AThinBeamTakesItsShareOfAnAreaLight) {
    const Context context = Context::headless();
    SurfelCloud cloud = testing::closed_room({-2.0f, -1.5f, 0.0f}, {2.0f, 1.5f, 2.4f}, 0.03f);
    const Vec3f low{-0.05f, -1.5f, 1.5f}, high{0.05f, 1.5f, 1.6f};
    for (const int axis : {0, 2}) {
        testing::add_wall(cloud, axis, low[axis], -1.0f, low, high, 0.015f);
        testing::add_wall(cloud, axis, high[axis], 1.0f, low, high, 0.015f);
    }
    const Octree octree = build_octree(std::move(cloud), {.depth = 6});
    const double edge = 0.7, height = 2.2;  // the light's half edge and where it hangs
    Scene scene;
    scene.area_lights.push_back({"panel",
                                 {{-edge, edge, height},
                                  {edge, edge, height},
                                  {edge, -edge, height},
                                  {-edge, -edge, height}},
                                 {5, 5, 5}});
    LightField light(context, octree.view(), scene);
    Frame frame(context, octree.view(), {.selection = {}, .wetness = 0.0f, .samples = 1});
    const View view = view_of(camera_at({-1.2, 0.1, 1.2}, {0.2, 0.0, 0.0}, 64, 48));
    const FrameLayers layers = frame.render(view, light);

    double is = 0, should = 0, unshadowed = 0;
    int pixels = 0;
    for (int py = 0; py < 48; ++py) {
        for (int px = 0; px < 64; ++px) {
            const ViewRay ray = ray_through(view, px + 0.5, py + 0.5);
            const Vec3d floor = ray.origin + ray.direction * (-ray.origin.z / ray.direction.z);
            if (ray.direction.z >= 0 || std::abs(floor.x) > 0.9 || std::abs(floor.y) > 1.2 ||
                !passes_by(ray.origin, floor, vec3_cast<double>(low), vec3_cast<double>(high)))
                continue;
            constexpr int kSide = 60;
            double all = 0, seen = 0;
            for (int i = 0; i < kSide * kSide; ++i) {
                const Vec3d point{edge * (2.0 * (i % kSide + 0.5) / kSide - 1.0),
                                  edge * (2.0 * (i / kSide + 0.5) / kSide - 1.0), height};
                const Vec3d way = point - floor;
                const double share = std::pow(height, 2.0) / std::pow(dot(way, way), 2.0);
                all += share;
                if (passes_by(floor, point, vec3_cast<double>(low), vec3_cast<double>(high)))
                    seen += share;
            }
            if (seen > 0.97 * all) continue;
            const double scale = 0.5 / M_PI * 5.0 * std::pow(2.0 * edge / kSide, 2.0);
            is += layers.direct[static_cast<std::size_t>(py * 64 + px)].x;
            should += scale * seen;
            unshadowed += scale * all;
            ++pixels;
        }
    }
    std::cout << pixels << " pixels in the beam's shadow: " << is / should - 1.0
              << " off in the mean; without the shadow " << unshadowed / should - 1.0 << "\n";
    ASSERT_GT(pixels, 200);
    EXPECT_NEAR(is / should, 1.0, 0.02);
    expect_no_errors(context);
}

/// The inside of a sphere of radius 1 m round the origin.
SurfelCloud sphere(int count) {
    SurfelCloud cloud;
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count, turn = i * 2.399963229728653;
        const double r = std::sqrt(1.0 - z * z);
        Surfel surfel;
        surfel.position = vec3_cast<float>(Vec3d{r * std::cos(turn), r * std::sin(turn), z});
        surfel.normal = -surfel.position;
        surfel.radius = static_cast<float>(2.0 / std::sqrt(double(count)));
        surfel.albedo = {0.5f, 0.5f, 0.5f};
        cloud.surfels.push_back(surfel);
    }
    return cloud;
}

TEST(FrameLight, AWetWallMirrorsTheRadianceOfAnEvenlyLitSphereByFresnelsShare) {
    const Context context = Context::headless();
    const Octree octree = build_octree(sphere(60000), {.depth = 5});
    const Scene scene = lamps(1, {0, 0, 0});
    LightField light(context, octree.view(), scene);
    light.converge();
    Frame frame(context, octree.view(), {.selection = {}, .wetness = 1.0f, .samples = 1});
    const View view = view_of(camera_at({-0.93, 0, 0}, {-0.8, 0.9, 0.1}, 40, 30));
    const FrameLayers layers = frame.render(view, light);

    // E = I / R^2 straight from the lamp and once more from the walls (albedo one half).
    const double radiance = 0.5 / M_PI * (3.0 + 3.0);
    double sum = 0, worst = 0;
    int pixels = 0;
    for (int py = 0; py < 30; ++py) {
        for (int px = 0; px < 40; ++px) {
            const std::size_t i = static_cast<std::size_t>(py * 40 + px);
            const Vec3d to_eye = normalized(ray_through(view, px + 0.5, py + 0.5).direction) * -1.0;
            const double cosine = dot(vec3_cast<double>(layers.normal[i]), to_eye);
            if (cosine > 0.6) continue;  // there the lamp itself glints
            const double fresnel = 0.02 + 0.98 * std::pow(1.0 - cosine, 5.0);
            const double error = layers.specular[i].x / (fresnel * radiance) - 1.0;
            sum += error;
            worst = std::max(worst, std::abs(error));
            ++pixels;
        }
    }
    std::cout << "specular over Fresnel's share: mean " << sum / pixels << ", worst " << worst
              << " of " << pixels << " pixels\n";
    ASSERT_GT(pixels, 100);
    EXPECT_NEAR(sum / pixels, 0.0, 0.03);
    EXPECT_LT(worst, 0.06);
    expect_no_errors(context);
}

}  // namespace
}  // namespace glowworm
