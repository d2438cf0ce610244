#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "viewer/frame/selection.h"
#include "viewer/frame/tile_bins.h"

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

std::vector<ChunkSelection> select(std::span<const Chunk> chunks, const View& view,
                                   const SelectionSettings& settings) {
    std::vector<ChunkBox> boxes;
    for (const Chunk& chunk : chunks) {
        const double half = chunk.box_edge / 2.0;
        const Vec3d low{chunk.box_min[0], chunk.box_min[1], chunk.box_min[2]};
        boxes.push_back({low + Vec3d{half, half, half}, {half, half, half}});
    }
    return select_chunks(chunks, boxes, kOrigin, view, settings);
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
    for (const auto& s : select(chunks, view_to_the_north(), {})) {
        seen.push_back(s.chunk);
    }
    EXPECT_THAT(seen, ::testing::ElementsAre(4, 0, 5)) << "nearest first";
}

TEST(Selection, DrawsAllOfANearChunkAndFewOfAFarOne) {
    const std::vector<Chunk> chunks = {chunk_at({0, 2, 0}, 1, 1000),
                                       chunk_at({0, 200, 0}, 1, 50000)};
    const SelectionSettings settings{.quality = 1.0f, .splat_scale = 2.0f};
    const View view = view_to_the_north();
    const auto selected = select(chunks, view, settings);
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
    const auto selected = select(chunks, view, {.quality = 1.0f});
    ASSERT_EQ(selected.size(), 1u);
    EXPECT_NEAR(selected[0].count, 100.0, 1.0) << "10 x 10 pixels, wherever it stands";
}

TEST(Selection, KeepsABudgetOfSurfelsByDrawingEvenlyFewer) {
    const std::vector<Chunk> chunks = {chunk_at({0, 2, 0}, 1, 1000), chunk_at({0, 4, 0}, 1, 3000)};
    const SelectionSettings settings{.quality = 0.1f, .splat_scale = 2.0f, .most_surfels = 200};
    const auto few = select(chunks, view_to_the_north(), settings);
    ASSERT_EQ(few.size(), 2u);
    EXPECT_EQ(few[0].count, 50u);
    EXPECT_EQ(few[1].count, 150u);
    EXPECT_NEAR(few[1].scale, 2.0 * std::sqrt(20.0), 1e-5);
}

TEST(Selection, FitsIntoBlocksEvenlyAndNeverLosesAChunk) {
    const std::vector<ChunkSelection> all = {{0, 1000, 2.0f}, {1, 4000, 2.0f}, {2, 10, 2.0f}};
    std::vector<ChunkSelection> same = all;
    fit_into(same, 10 + 40 + 1, 100);
    EXPECT_EQ(same[1].count, 4000u) << "it fits";

    std::vector<ChunkSelection> half = all;
    fit_into(half, 26, 100);
    EXPECT_NEAR(half[0].count, 500, 100);
    EXPECT_NEAR(half[1].count, 2000, 100);
    EXPECT_EQ(half[2].count, 10u) << "less than a block";
    EXPECT_NEAR(half[1].scale, 2.0 * std::sqrt(4000.0 / half[1].count), 1e-5);
    std::uint64_t blocks = 0;
    for (const ChunkSelection& selected : half)
        blocks += (selected.count + 99) / 100;
    EXPECT_LE(blocks, 26u);

    std::vector<ChunkSelection> least = all;
    fit_into(least, 0, 100);
    EXPECT_EQ(least[0].count, 100u) << "a block each, whatever there is";
}

TEST(Selection, DrawsAllOfWhatItTakesAsFarAsTheirSpacingIsWhatIsAskedFor) {
    const std::vector<Chunk> chunks = {chunk_at({0, 8, 0}, 1, 100000)};
    const View view = view_to_the_north();
    const SelectionSettings settings{.quality = 0.7f};
    const auto selected = select(chunks, view, settings);
    ASSERT_EQ(selected.size(), 1u);
    ASSERT_LT(selected[0].count, 100000u);
    const double spacing = chunks[0].spacing * std::sqrt(100000.0 / selected[0].count);
    EXPECT_NEAR(spacing * view.focal / selected[0].full_depth, 0.7, 1e-3) << "pixels";
    const ChunkSelection fewer = thinned(selected[0], selected[0].count / 4);
    EXPECT_NEAR(fewer.full_depth, 2.0 * selected[0].full_depth, 0.01);
    EXPECT_NEAR(fewer.scale, 2.0 * selected[0].scale, 0.01);
}

TEST(TileBins, HoldTheBoxesThatTouchThemAndNoOthers) {
    constexpr int kWidth = 100, kHeight = 70, kColumns = 4, kRows = 3;
    constexpr std::size_t kRun = 64;
    const std::vector<std::uint32_t> used = {64, 0, 17, 40, 1};
    std::mt19937 random(6);
    std::uniform_int_distribution<int> x(0, kWidth - 1), y(0, kHeight - 1), size(-1, 40);
    std::vector<PixelBox> boxes(used.size() * kRun);
    for (PixelBox& box : boxes) {
        box.low_x = static_cast<std::int16_t>(x(random));
        box.low_y = static_cast<std::int16_t>(y(random));
        box.high_x = static_cast<std::int16_t>(std::min(box.low_x + size(random), kWidth - 1));
        box.high_y = static_cast<std::int16_t>(std::min(box.low_y + size(random), kHeight - 1));
    }
    const TileBins bins(boxes, kRun, used, kWidth, kHeight);
    constexpr int kTile = TileBins::kTile;
    for (int tile = 0; tile < kColumns * kRows; ++tile) {
        const int left = tile % kColumns * kTile, top = tile / kColumns * kTile;
        std::vector<std::uint32_t> truth;
        for (std::uint32_t i = 0; i < boxes.size(); ++i) {
            const PixelBox& box = boxes[i];
            if (i % kRun < used[i / kRun] && !box.empty() && box.high_x >= left &&
                box.high_y >= top && box.low_x < left + kTile && box.low_y < top + kTile)
                truth.push_back(i);
        }
        const auto bin = bins.of(static_cast<std::size_t>(tile));
        EXPECT_EQ(std::vector<std::uint32_t>(bin.begin(), bin.end()), truth) << tile;
    }
}

TEST(Selection, ReturnsNothingForNothing) {
    EXPECT_TRUE(select({}, view_to_the_north(), {}).empty());
    EXPECT_TRUE(
        select(std::vector<Chunk>{chunk_at({0, 9, 0}, 1, 0)}, view_to_the_north(), {}).empty())
        << "a chunk without surfels";
}

}  // namespace
}  // namespace glowworm
