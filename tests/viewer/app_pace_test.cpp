#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "viewer/app/pace.h"

namespace glowworm {
namespace {

TEST(Pace, ShowsTheFirstPictureCoarselyAndAtOnce) {
    EXPECT_EQ(Pace().divisor(false), 8);
}

TEST(Pace, DrawsFullyWhereTheMachineIsFast) {
    Pace pace;
    pace.drawn(8, 0.0001);
    EXPECT_EQ(pace.divisor(true), 1);
}

TEST(Pace, KeepsMovementFluentAndRestSharp) {
    Pace pace;
    pace.drawn(8, 0.02);  // 1.28 s for all pixels
    EXPECT_EQ(pace.divisor(true), 4);
    EXPECT_EQ(pace.divisor(false), 1);
}

TEST(Pace, ForgetsASlowMomentWithinAFewFrames) {
    Pace pace;
    pace.drawn(1, 30.0);
    EXPECT_EQ(pace.divisor(true), 8);
    for (int i = 0; i < 12; ++i)
        pace.drawn(2, 0.01);
    EXPECT_EQ(pace.divisor(true), 1);
}

}  // namespace
}  // namespace glowworm
