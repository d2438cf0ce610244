#include <gmock/gmock.h>

#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include "analytic_cave.h"
#include "octree/build.h"
#include "viewer/app/live_light.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

using ::testing::HasSubstr;
using testing::lamp_at;

Octree at_depth(const SurfelCloud& cloud, std::uint32_t depth) {
    BuildSettings settings;
    settings.depth = depth;
    return build_octree(cloud, settings);
}

double mean_indirect(const LightField& field) {
    const auto values = field.read_indirect();
    double sum = 0.0;
    for (const gpu::vec4& value : values)
        sum += static_cast<double>(value.y);
    return sum / static_cast<double>(values.size());
}

TEST(LiveLight, ShowsDirectLightThenAPreviewAndNeverGoesBackToTheDark) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.03f), 6);
    const Scene scene = lamp_at({0.5, 0.5, 0.5});
    LightField all_at_once(context, octree.view(), scene);
    all_at_once.converge(1e-3);
    const double settled_light = mean_indirect(all_at_once);

    LiveLight light(context, octree.view(), scene, {}, std::nullopt);
    EXPECT_EQ(mean_indirect(light.field()), 0.0);
    EXPECT_THAT(light.status(), HasSubstr("direct only"));
    std::uint32_t rays = 0;
    double latest = 0.0;
    std::vector<std::uint32_t> shown;
    while (!light.settled()) {
        if (!light.advance()) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
            continue;
        }
        const std::uint32_t now = light.field().links().rays();
        const double mean = mean_indirect(light.field());
        EXPECT_GE(now, rays);
        if (now > rays) {
            shown.push_back(now);
            EXPECT_TRUE(now == 128 || light.status().find("preview by") != std::string::npos);
            EXPECT_GT(mean, 0.8 * latest) << "went dark when " << now << " rays took over";
        }
        rays = now;
        latest = mean;
    }
    std::cout << "shown by " << ::testing::PrintToString(shown) << " rays; light "
              << latest / settled_light << " of what tracing all at once settles at\n";
    EXPECT_EQ(shown.back(), 128u);
    EXPECT_NEAR(latest, settled_light, 1e-3 * settled_light);
    EXPECT_THAT(light.status(), HasSubstr("settled after"));
    EXPECT_THAT(light.status(), ::testing::Not(HasSubstr("tracing")));
}

TEST(LiveLight, TheFirstRaysOfEveryLobeAreNearerThanCones) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.03f), 6);
    const Scene scene = lamp_at({0.5, 0.5, 0.5});
    const auto settled = [&](const LightSettings& settings) {
        LightField field(context, octree.view(), scene, settings);
        field.converge(1e-3);
        return field.read_indirect();
    };
    const auto truth = settled({.links = 256});
    const auto error_of = [&](const std::vector<gpu::vec4>& light) {
        double sum = 0.0;
        double of = 0.0;
        for (std::size_t i = 0; i < truth.size(); ++i) {
            sum += std::abs(static_cast<double>(light[i].y - truth[i].y));
            of += static_cast<double>(truth[i].y);
        }
        return sum / of;
    };
    const double preview = error_of(settled({.links = 16}));
    const double cones = error_of(settled({.gather = Gather::kCones}));
    std::cout << "mean error of lobes against 256 rays: 16 rays " << 100.0 * preview
              << " %, 6 cones " << 100.0 * cones << " %\n";
    EXPECT_LT(preview, cones);
}

TEST(LiveLight, AGpuTracesInStepsWhatItTracesAtOnce) {
    const Context context = Context::headless();
    const Octree octree = at_depth(testing::dogleg(0.05f), 5);
    const LightSettings settings{.links = 64, .run_on = RunOn::kGpu};
    LightField at_once(context, octree.view(), lamp_at({0.5, 0.5, 0.5}), settings);
    at_once.prepare();
    LightField in_steps(context, octree.view(), lamp_at({0.5, 0.5, 0.5}), settings);
    std::vector<std::uint32_t> steps;
    while (in_steps.prepare_more())
        steps.push_back(in_steps.links().rays());
    EXPECT_THAT(steps, ::testing::ElementsAre(16u, 32u, 64u));
    EXPECT_EQ(in_steps.links().read(), at_once.links().read());
}

}  // namespace
}  // namespace glowworm
