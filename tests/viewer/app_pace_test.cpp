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

/// What `pace` settles on where a frame of 1/d x 1/d of the pixels takes fixed + full / d² seconds.
int settled(bool moving, double fixed, double full) {
    Pace pace;
    for (int i = 0; i < 20; ++i) {
        const int divisor = pace.divisor(moving);
        pace.drawn(divisor, fixed + full / (divisor * divisor));
    }
    return pace.divisor(moving);
}

TEST(Pace, KeepsMovementFluentAndRestSharpWherePixelsCost) {
    EXPECT_EQ(settled(true, 0.0, 1.28), 4);  // 0.08 s
    EXPECT_EQ(settled(false, 0.0, 1.28), 2);
}

TEST(Pace, KeepsRestSharpWhereTheCaveCosts) {
    EXPECT_EQ(settled(true, 0.2, 0.6), 8);
    EXPECT_EQ(settled(false, 0.2, 0.6), 2);
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
