#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "viewer/frame/selection.h"

namespace glowworm {
namespace {

constexpr Vec3d kOrigin{1000.0, 2000.0, 30.0};

Chunk chunk_at(Vec3f middle, float edge, std::uint32_t count) {
    Chunk chunk{};
    for (int axis = 0; axis < 3; ++axis)
        chunk.box_min[axis] = middle[axis] - edge / 2;
    chunk.box_edge = edge;
    chunk.count = count;
    chunk.spacing = edge / std::sqrt(static_cast<float>(count));
    chunk.max_radius = chunk.spacing;
    return chunk;
}

View view_to_the_north() {
    Camera camera;
    camera.position = kOrigin;
    camera.look_at = kOrigin + Vec3d{0, 1, 0};
    return view_of(camera);
}

TEST(Selection, LeavesOutWhatTheViewCannotSee) {
    const std::vector<Chunk> chunks = {
        chunk_at({0, 10, 0}, 1, 100),     // ahead
        chunk_at({0, -10, 0}, 1, 100),    // behind
        chunk_at({30, 10, 0}, 1, 100),    // right of the picture
        chunk_at({0, 10, -30}, 1, 100),   // below the picture
        chunk_at({0, 0, 0}, 1, 100),      // around the eye
        chunk_at({7.9f, 10, 0}, 1, 100),  // across the picture's right edge
    };
    std::vector<std::uint32_t> seen;
    for (const auto& s : select_chunks(chunks, kOrigin, view_to_the_north(), {})) {
        seen.push_back(s.chunk);
    }
    EXPECT_THAT(seen, ::testing::ElementsAre(4, 0, 5)) << "nearest first";
}

TEST(Selection, DrawsAllOfANearChunkAndFewOfAFarOne) {
    const std::vector<Chunk> chunks = {chunk_at({0, 2, 0}, 1, 1000),
                                       chunk_at({0, 200, 0}, 1, 50000)};
    const SelectionSettings settings{.quality = 1.0f, .splat_scale = 2.0f};
    const View view = view_to_the_north();
    const auto selected = select_chunks(chunks, kOrigin, view, settings);
    ASSERT_EQ(selected.size(), 2u);
    EXPECT_EQ(selected[0].count, 1000u);
    EXPECT_EQ(selected[0].scale, 2.0f);

    // The far one's nearest side spans focal / 199.5 pixels: that many squared at one pixel apart.
    const double pixels = view.focal / 199.5;
    EXPECT_NEAR(selected[1].count, pixels * pixels, 1.0);
    EXPECT_NEAR(selected[1].scale, 2.0 * std::sqrt(50000.0 / selected[1].count), 1e-3)
        << "what is left grows to cover the same surface";
}

TEST(Selection, CountsPixelsByScaleInAnOrthographicView) {
    View view = view_to_the_north();
    view.orthographic = true;
    view.focal = 10.0;  // pixels per m
    const std::vector<Chunk> chunks = {chunk_at({0, 50, 0}, 1, 50000)};
    const auto selected = select_chunks(chunks, kOrigin, view, {.quality = 1.0f});
    ASSERT_EQ(selected.size(), 1u);
    EXPECT_NEAR(selected[0].count, 100.0, 1.0) << "10 x 10 pixels, wherever it stands";
}

TEST(Selection, KeepsABudgetOfSurfelsAndWhatIsResidentByDrawingEvenlyFewer) {
    const std::vector<Chunk> chunks = {chunk_at({0, 2, 0}, 1, 1000), chunk_at({0, 4, 0}, 1, 3000)};
    SelectionSettings settings{.quality = 0.1f, .splat_scale = 2.0f, .resident = 0.5};
    const auto half = select_chunks(chunks, kOrigin, view_to_the_north(), settings);
    ASSERT_EQ(half.size(), 2u);
    EXPECT_EQ(half[0].count, 500u);
    EXPECT_EQ(half[1].count, 1500u);
    EXPECT_NEAR(half[0].scale, 2.0 * std::sqrt(2.0), 1e-5);

    settings.most_surfels = 200;
    const auto few = select_chunks(chunks, kOrigin, view_to_the_north(), settings);
    EXPECT_EQ(few[0].count, 50u);
    EXPECT_EQ(few[1].count, 150u);
    EXPECT_NEAR(few[1].scale, 2.0 * std::sqrt(20.0), 1e-5);
}

TEST(Selection, ReturnsNothingForNothing) {
    EXPECT_TRUE(select_chunks({}, kOrigin, view_to_the_north(), {}).empty());
    EXPECT_TRUE(select_chunks(std::vector<Chunk>{chunk_at({0, 9, 0}, 1, 0)}, kOrigin,
                              view_to_the_north(), {})
                    .empty())
        << "a chunk without surfels";
}

}  // namespace
}  // namespace glowworm
