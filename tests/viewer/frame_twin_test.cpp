// Passes as compiled code beside the same passes as shaders, pixel by pixel.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "analytic_cave.h"
#include "camera_at.h"
#include "octree/build.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

/// A lamp, a spot and an area light in a room with a beam.
Scene three_lights() {
    Scene scene;
    scene.point_lights.push_back({"lamp", {0.5, 0.3, 1.4}, {3, 2, 1}});
    SpotLight& spot = scene.spot_lights.emplace_back();
    spot.position = {-1.0, -0.5, 2.0};
    spot.direction = {0.5, 0.2, -1.0};
    spot.cone_deg = 50.0;
    spot.blend = 0.3;
    spot.radiant_intensity = {4, 4, 4};
    scene.area_lights.push_back(
        {"panel",
         {{-0.4, 0.4, 2.2}, {0.4, 0.4, 2.2}, {0.4, -0.4, 2.2}, {-0.4, -0.4, 2.2}},
         {5, 5, 5}});
    return scene;
}

constexpr double kRounding = 1e-4;
constexpr double kConeStep = 1e-2;  // a cone that is nearly ended may take one more or less

/// How many pixels of a layer differ by more than a share `bound`; prints them beside the others.
std::size_t ties(const char* name, const std::vector<Vec3f>& a, const std::vector<Vec3f>& b,
                 double bound = kRounding) {
    double sum = 0, differences = 0;
    std::size_t differing = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double scale = length(vec3_cast<double>(a[i])),
                     off = length(vec3_cast<double>(a[i] - b[i]));
        sum += scale;
        differences += off;
        differing += off > bound * scale;
    }
    std::cout << name << ": " << differing << " of " << a.size() << " pixels differ by more than "
              << bound << ", " << differences / sum << " in the mean\n";
    EXPECT_GT(sum, 0.0);
    EXPECT_LT(differences, (bound > kRounding ? 10.0 : 1.0) * kRounding * sum);
    return differing;
}

TEST(FrameTwin, CompiledShadingDrawsWhatTheShadersDraw) {
    const Context context = Context::headless();
    if (!context.device().software) GTEST_SKIP() << "OpenGL runs on a GPU: shaders do all of it";
    SurfelCloud cloud = testing::closed_room({-2.0f, -1.5f, 0.0f}, {2.0f, 1.5f, 2.4f}, 0.04f);
    const Vec3f low{-0.05f, -1.5f, 1.5f}, high{0.05f, 1.5f, 1.6f};
    testing::add_wall(cloud, 2, low.z, -1.0f, low, high, 0.02f);
    testing::add_wall(cloud, 2, high.z, 1.0f, low, high, 0.02f);
    const Octree octree = build_octree(std::move(cloud), {.depth = 5});
    const Scene scene = three_lights();
    LightField light(context, octree.view(), scene);
    light.iterate(2);
    const View view = view_of(testing::camera_at({-1.6, -1.1, 1.0}, {0.6, 0.3, 1.4}, 80.0, 61, 43));
    Frame frame(context, octree.view(), {.samples = 2});
    frame.set_panels(scene.area_lights);
    for (const float wetness : {0.0f, 0.7f}) {
        frame.force_shaders(false);
        frame.set_wetness(wetness);
        const FrameLayers compiled = frame.render(view, light);
        const FrameLayers again = frame.render(view, light);
        frame.force_shaders(true);
        const FrameLayers shaded = frame.render(view, light);

        EXPECT_EQ(compiled.direct, again.direct);
        EXPECT_EQ(compiled.indirect, again.indirect);
        EXPECT_EQ(compiled.specular, again.specular);
        EXPECT_EQ(compiled.emission, shaded.emission);
        EXPECT_LE(ties("direct", shaded.direct, compiled.direct), 5u);
        EXPECT_LE(ties("indirect", shaded.indirect, compiled.indirect), 5u);
        if (wetness > 0.0f) {
            EXPECT_LE(ties("specular", shaded.specular, compiled.specular, kConeStep), 5u);
        }
    }
    for (const std::string& error : context.errors())
        ADD_FAILURE() << error;
}

/// Random points of a room, of a block in its middle, and of a strip that pokes out of a hole in a
/// wall: gaps, rims and outlines against nothing.
SurfelCloud ragged_room() {
    SurfelCloud even = testing::closed_room({-2.0f, -1.5f, 0.0f}, {2.0f, 1.5f, 2.4f}, 0.03f);
    testing::add_wall(even, 0, -0.3f, -1.0f, {-0.3f, -0.6f, 0.5f}, {0.3f, 0.6f, 1.3f}, 0.02f);
    testing::add_wall(even, 1, -0.6f, -1.0f, {-0.3f, -0.6f, 0.5f}, {0.3f, 0.6f, 1.3f}, 0.02f);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    SurfelCloud ragged;
    for (Surfel& surfel : even.surfels) {
        const Vec3f& p = surfel.position;
        const bool in_hole = p.x > 1.9f && std::abs(p.y) < 0.5f && std::abs(p.z - 1.2f) < 0.4f;
        if (in_hole || unit(random) < 0.4f) continue;
        surfel.albedo = {unit(random), 0.5f, 0.2f};
        for (int axis = 0; axis < 3; ++axis)
            surfel.position[axis] += 0.02f * (unit(random) - 0.5f);
        ragged.surfels.push_back(surfel);
    }
    return ragged;
}

/// Pixels of a view as compiled code draws them that differ from the shaders'.
struct Ties {
    std::size_t pixels = 0, hits = 0, ties = 0;
    double off = 0;  // in the mean of those that are not ties
};

Ties draw_both(Frame& frame, const View& view) {
    Ties all;
    all.pixels = static_cast<std::size_t>(view.width * view.height);
    std::vector<std::vector<gpu::vec4>> surfaces, albedos;
    for (const bool shaders : {false, false, true}) {
        frame.force_shaders(shaders);
        frame.draw_surfaces(view, Frame::Missing::kWaitFor);
        surfaces.push_back(frame.gbuffer().surfaces().read<gpu::vec4>(all.pixels));
        albedos.push_back(frame.gbuffer().albedos().read<gpu::vec4>(all.pixels));
    }
    EXPECT_EQ(surfaces[0], surfaces[1]) << "drawn twice";
    EXPECT_EQ(albedos[0], albedos[1]) << "drawn twice";
    for (std::size_t i = 0; i < all.pixels; ++i) {
        const gpu::vec4 surface = surfaces[0][i] - surfaces[2][i];
        const gpu::vec4 albedo = albedos[0][i] - albedos[2][i];
        const double apart =
            std::max({std::abs(surface.x), std::abs(surface.y), std::abs(surface.z),
                      std::abs(surface.w), std::abs(albedo.x), std::abs(albedo.w)});
        all.hits += surfaces[2][i].w > 0 ? 1 : 0;
        all.ties += apart > 1e-3 ? 1 : 0;  // a disc more or less, by rounding
        if (apart <= 1e-3) all.off += apart / static_cast<double>(all.pixels);
    }
    std::cout << all.hits << " of " << all.pixels << " pixels see a surface, " << all.ties
              << " differ by a disc, the others by " << all.off << " in the mean\n";
    return all;
}

TEST(FrameTwin, CompiledSplattingDrawsWhatTheShadersDraw) {
    const Context context = Context::headless();
    if (!context.device().software) GTEST_SKIP() << "OpenGL runs on a GPU: shaders do all of it";
    const Octree octree = build_octree(ragged_room(), {.depth = 5});
    Frame frame(context, octree.view());
    const View whole =
        view_of(testing::camera_at({-1.7, -1.2, 0.9}, {0.6, 0.3, 1.2}, 80.0, 203, 157));
    View orthographic = whole;
    orthographic.orthographic = true;
    orthographic.focal = 60.0;
    View clipped = whole;
    clipped.clip = WorldBox{{-1.0, -2.0, 0.2}, {2.1, 2.0, 2.0}};
    for (const View& view : {whole, orthographic, clipped}) {
        const Ties both = draw_both(frame, view);
        EXPECT_GT(both.hits, both.pixels / 3);
        EXPECT_LT(both.hits, both.pixels) << "nothing is seen through the hole";
        EXPECT_LE(both.ties, both.pixels / 1000);
        EXPECT_LT(both.off, 2e-5);
    }
    for (const std::string& error : context.errors())
        ADD_FAILURE() << error;
}

TEST(FrameTwin, CompiledSplattingLeavesOutHiddenDiscsWithoutChangingAPixel) {
    const Context context = Context::headless();
    if (!context.device().software) GTEST_SKIP() << "OpenGL runs on a GPU: shaders do all of it";
    // Wide discs of a wall with a window before the eye; behind it ever more, ever smaller ones.
    SurfelCloud cloud = testing::closed_room({-2.0f, -1.5f, 0.0f}, {2.0f, 1.5f, 2.4f}, 0.02f);
    SurfelCloud wall;
    testing::add_wall(wall, 0, -1.0f, -1.0f, {-1.0f, -1.5f, 0.0f}, {-1.0f, 1.5f, 2.4f}, 0.06f);
    for (const Surfel& surfel : wall.surfels) {
        const double from_window =
            std::hypot(double{surfel.position.y}, double{surfel.position.z} - 1.2);
        if (from_window > 0.25) cloud.surfels.push_back(surfel);
    }
    for (const float x : {0.0f, 1.0f}) {
        testing::add_wall(cloud, 0, x, -1.0f, {x, -1.4f, 0.0f}, {x, 0.1f, 2.0f}, 0.01f);
        testing::add_wall(cloud, 0, x, -1.0f, {x, 0.4f, 0.5f}, {x, 1.4f, 2.4f}, 0.01f);
    }
    const Octree octree = build_octree(std::move(cloud), {.depth = 6});
    Frame frame(context, octree.view());
    for (const Vec3d& eye : {Vec3d{-1.3, 0.1, 1.2}, {-1.6, -0.4, 1.0}, {-1.9, 0.6, 1.5}}) {
        const Ties both =
            draw_both(frame, view_of(testing::camera_at(eye, {0.6, 0.1, 1.2}, 80.0, 203, 157)));
        EXPECT_EQ(both.hits, both.pixels);
        EXPECT_LE(both.ties, both.pixels / 1000);
        EXPECT_LT(both.off, 2e-5);
    }
}

}  // namespace
}  // namespace glowworm
