#include <gmock/gmock.h>

#include <cmath>

#include "octree/error.h"
#include "viewer/light/anderson.h"
#include "viewer/light/cones.h"

namespace glowworm {
namespace {

using ::testing::ElementsAre;

TEST(Cones, EverySetOfConesCoversTheHemisphereOnceByCosine) {
    for (const bool faithful : {false, true}) {
        for (const int count : {4, 5, 6, 9, 10, 16}) {
            double weights = 0.0, upward = 0.0;
            for (const gpu::vec4& cone : cone_set(count, faithful)) {
                weights += cone.w;
                upward += cone.w * std::sqrt(1.0 - cone.x);
            }
            EXPECT_NEAR(weights, 1.0, 1e-6);
            // Cosine-weighted, the mean cosine of the hemisphere is 2/3; few cones come near it.
            EXPECT_NEAR(upward, 2.0 / 3.0, 0.07) << count << (faithful ? " faithful" : "");
        }
    }
    EXPECT_THROW(cone_set(7, false), Error);
}

TEST(Anderson, WeightsSolveTheLeastSquaresAndRefuseNonsense) {
    // d0 = (1, 0), d1 = (1, 1), r = (3, 2): r = 1 d0 + 2 d1.
    const auto weights = anderson_weights({1.0, 1.0, 0.0, 2.0, 0.0, 0.0, 3.0, 5.0, 0.0}, 2);
    EXPECT_NEAR(weights[0], 1.0, 1e-5);
    EXPECT_NEAR(weights[1], 2.0, 1e-5);
    EXPECT_EQ(weights[2], 0.0f);
    EXPECT_THAT(anderson_weights({}, 3), ElementsAre(0.0f, 0.0f, 0.0f));
    const double nan = std::nan("");
    EXPECT_THAT(anderson_weights({nan, 0, 0, nan, 0, 0, 0, 0, 0}, 2),
                ElementsAre(0.0f, 0.0f, 0.0f));
}

}  // namespace
}  // namespace glowworm
