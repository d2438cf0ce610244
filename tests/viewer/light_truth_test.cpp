#include <gmock/gmock.h>

#include <iomanip>
#include <iostream>

#include "gi_scene.h"
#include "octree/build.h"
#include "testing.h"
#include "viewer/gpu/context.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm {
namespace {

using testing::GiScene;

/// What a scene's probes may be off by on average, relative to max(truth, 2 % of the mean).
struct Goal {
    const char* scene;
    double direct;
    double indirect;
};

class LightTruth : public ::testing::TestWithParam<Goal> {};

TEST_P(LightTruth, ProbesAgreeWithAnotherRenderer) {
    GLOWWORM_DATA_OR_SKIP(data);
    const Goal goal = GetParam();
    const GiScene gi = testing::read_gi_scene(data / "gi" / goal.scene);
    const Octree octree = build_octree(gi.cloud);
    const Context context = Context::headless();
    LightField field(context, octree.view(), gi.scene);
    const Convergence convergence = field.converge();

    std::vector<Probe> probes;
    std::vector<Vec3d> true_direct, true_indirect, direct, indirect;
    for (const GiScene::Truth& truth : gi.probes) {
        probes.push_back({truth.position, truth.normal});
        true_direct.push_back(truth.direct);
        true_indirect.push_back(truth.indirect);
    }
    for (const ProbeResult& result : measure_light(field, probes)) {
        direct.push_back(vec3_cast<double>(result.direct));
        indirect.push_back(vec3_cast<double>(result.indirect));
    }
    const double direct_error = testing::mean_relative_error(direct, true_direct);
    const double indirect_error = testing::mean_relative_error(indirect, true_indirect);
    std::cout << std::fixed << std::setprecision(2) << goal.scene << ": depth " << octree.grid.depth
              << ", " << octree.lobes.size() << " lobes, " << field.settings().links << " links, "
              << convergence.bounces << " bounces; mean error direct " << 100.0 * direct_error
              << " %, indirect " << 100.0 * indirect_error << " %\n";
    EXPECT_TRUE(convergence.settled);
    EXPECT_LE(direct_error, goal.direct);
    EXPECT_LE(indirect_error, goal.indirect);
    EXPECT_THAT(context.errors(), ::testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Scenes, LightTruth,
                         ::testing::Values(Goal{"A_sphere_c05", 0.005, 0.002},
                                           Goal{"A_sphere_o08", 0.005, 0.005},
                                           Goal{"B_box", 0.015, 0.012},
                                           Goal{"C_dogleg", 0.015, 0.035},
                                           Goal{"D_cavern", 0.015, 0.035}),
                         [](const auto& goal) { return goal.param.scene; });

}  // namespace
}  // namespace glowworm
