// Passes as compiled code beside the same passes as shaders, pixel by pixel.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "analytic_cave.h"
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

/// How many pixels of a layer differ by more than rounding; prints them beside the others.
std::size_t ties(const char* name, const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    double sum = 0, differences = 0;
    std::size_t differing = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double scale = length(vec3_cast<double>(a[i])),
                     off = length(vec3_cast<double>(a[i] - b[i]));
        sum += scale;
        differences += off;
        differing += off > 1e-4 * scale;
    }
    std::cout << name << ": " << differing << " of " << a.size()
              << " pixels differ by more than 1e-4"
              << ", " << differences / sum << " in the mean\n";
    EXPECT_GT(sum, 0.0);
    EXPECT_LT(differences, 1e-4 * sum);
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
    Camera camera;
    camera.position = {-1.6, -1.1, 1.0};
    camera.look_at = {0.6, 0.3, 1.4};
    camera.vfov_deg = 80.0;
    camera.width = 61;
    camera.height = 43;
    const View view = view_of(camera);
    Frame frame(context, octree.view(), {.samples = 2});
    frame.set_panels(scene.area_lights);
    const FrameLayers compiled = frame.render(view, light);
    const FrameLayers again = frame.render(view, light);
    frame.force_shaders(true);
    const FrameLayers shaded = frame.render(view, light);

    EXPECT_EQ(compiled.direct, again.direct);
    EXPECT_EQ(compiled.indirect, again.indirect);
    EXPECT_EQ(compiled.emission, shaded.emission);
    EXPECT_LE(ties("direct", shaded.direct, compiled.direct), 5u);
    EXPECT_LE(ties("indirect", shaded.indirect, compiled.indirect), 5u);
    for (const std::string& error : context.errors())
        ADD_FAILURE() << error;
}

}  // namespace
}  // namespace glowworm
