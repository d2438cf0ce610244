// Frames of clouds that are not, or not all, on the GPU yet.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <iostream>
#include <thread>

#include "analytic_cave.h"
#include "camera_at.h"
#include "octree/build.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

using ::testing::IsEmpty;

/// A bent passage of enough points for many chunks.
struct Passage {
    Context context = Context::headless();
    Octree octree = build_octree(testing::dogleg(0.008f), {.depth = 5});
    Scene scene{{{"lamp", {3.5, 0.5, 0.6}, {3, 3, 3}}}, {}, {}, {}};
    LightField light{context, octree.view(), scene};

    Frame frame(std::uint64_t memory = 0) const {
        return Frame(context, octree.view(),
                     {.selection = {}, .point_memory = memory, .samples = 1});
    }
};

View view_from(const Vec3d& position, const Vec3d& look_at) {
    return view_of(testing::camera_at(position, look_at, 60.0, 64, 48));
}

std::vector<float> beauty_of(const Frame& frame) {
    return frame.beauty().read<float>(std::size_t{64 * 48 * 4});
}

TEST(Streaming, LeavesOutWhatIsHiddenWithoutChangingAPixel) {
    const Passage passage;
    ASSERT_GT(passage.octree.chunks.size(), 6u);
    const View ahead = view_from({0.3, 0.5, 0.5}, {4.0, 0.5, 0.5});   // to the bend
    const View aside = view_from({3.5, 3.7, 0.5}, {3.5, 0.0, 0.45});  // from the other end
    Frame fresh = passage.frame(), walked = passage.frame();
    fresh.draw(ahead, passage.light, Frame::Missing::kWaitFor);
    const std::vector<float> truth = beauty_of(fresh);
    for (const View& view : {aside, ahead, ahead}) {
        walked.draw(view, passage.light, Frame::Missing::kWaitFor);
        std::cout << "drawn " << walked.surfels_drawn() << ", hidden " << walked.surfels_hidden()
                  << "\n";
    }
    EXPECT_EQ(beauty_of(walked), truth) << "whatever was seen before";
    EXPECT_GT(walked.surfels_hidden(), 0u) << "the end of the leg round the bend";
    EXPECT_THAT(passage.context.errors(), IsEmpty());
}

TEST(Streaming, BecomesTheWholeFrameWhileItIsDrawnAgain) {
    const Passage passage;
    const View view = view_from({0.3, 0.5, 0.5}, {4.0, 0.5, 0.5});
    Frame all = passage.frame(), growing = passage.frame();
    all.draw(view, passage.light, Frame::Missing::kWaitFor);

    growing.draw(view, passage.light);
    EXPECT_FALSE(growing.is_complete());
    EXPECT_LT(growing.surfels_drawn(), all.surfels_drawn());
    const auto depths = growing.gbuffer().surfaces().read<gpu::vec4>(std::size_t{64 * 48});
    EXPECT_TRUE(std::ranges::all_of(depths, [](const gpu::vec4& s) { return s.w > 0.0f; }))
        << "coarse, but no hole";
    int frames = 1;
    for (; !growing.is_complete() && frames < 2000; ++frames) {
        growing.draw(view, passage.light);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    std::cout << "complete after " << frames << " frames\n";
    ASSERT_TRUE(growing.is_complete());
    growing.draw(view, passage.light);
    EXPECT_EQ(beauty_of(growing), beauty_of(all));
}

TEST(Streaming, KeepsWithinItsMemoryWhereverItLooks) {
    const Passage passage;
    const std::uint64_t memory = passage.octree.view().surfels.size_bytes() / 8;
    Frame frame = passage.frame(memory);
    const std::uint64_t most = memory / sizeof(PackedSurfel);
    for (const Vec3d& aim : {Vec3d{4, 0.5, 0.5}, {0.3, 0.5, 0.0}, {4, 0.9, 0.2}, {0.0, 0.5, 0.5}}) {
        const View view = view_from({0.7, 0.5, 0.5}, aim);
        for (const auto missing : {Frame::Missing::kAskFor, Frame::Missing::kWaitFor}) {
            frame.draw(view, passage.light, missing);
            EXPECT_GT(frame.surfels_drawn(), 0u);
            EXPECT_LE(frame.surfels_drawn(), most);
            const auto depths = frame.gbuffer().surfaces().read<gpu::vec4>(std::size_t{64 * 48});
            EXPECT_TRUE(std::ranges::all_of(depths, [](const gpu::vec4& s) { return s.w > 0.0f; }))
                << "no hole";
        }
    }
    EXPECT_THAT(passage.context.errors(), IsEmpty());
}

}  // namespace
}  // namespace glowworm
