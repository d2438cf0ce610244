// A small frame as it was when somebody looked at it and found it right.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iostream>

#include "analytic_cave.h"
#include "camera_at.h"
#include "octree/build.h"
#include "viewer/frame/exr.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

// Linear light: what rounding of another driver may change in the mean, and what in the few pixels
// where a silhouette or a shadow falls on the other side.
constexpr double kMeanTolerance = 0.005, kPixelTolerance = 0.02, kShareBeyond = 0.02;

FrameLayers golden_frame(const Context& context, View& view) {
    const Octree octree = build_octree(testing::dogleg(0.06f), {.depth = 5});
    const AreaLight panel{"panel",
                          {{1.2, 0.2, 0.98}, {1.2, 0.8, 0.98}, {1.8, 0.8, 0.98}, {1.8, 0.2, 0.98}},
                          {4, 3, 2}};
    const Scene scene{{{"lamp", {3.5, 1.5, 0.5}, {1, 1, 2}}}, {}, {panel}, {}};
    LightField light(context, octree.view(), scene);
    light.iterate(4);
    Frame frame(context, octree.view(), {.selection = {}, .wetness = 0.5f, .samples = 2});
    frame.set_panels(scene.area_lights);
    view = view_of(testing::camera_at({0.3, 0.5, 0.5}, {3.5, 0.6, 0.45}, 70.0, 40, 30));
    return frame.render(view, light);
}

TEST(FrameGolden, LooksAsItDid) {
    const std::filesystem::path golden = GLOWWORM_GOLDEN_FRAME;
    const Context context = Context::headless();
    View view;
    const std::string now = encode_exr(golden_frame(context, view), view);
    const std::filesystem::path fresh = ::testing::TempDir() + "glowworm_golden_now.exr";
    std::ofstream(fresh, std::ios::binary) << now;
    const ExrChannels is = read_exr(fresh), was = read_exr(golden);
    ASSERT_EQ(is.width, was.width);
    for (const char* channel : {"R", "direct.R", "indirect.G", "specular.B", "emission.R", "Z"}) {
        const auto &a = is.channels.at(channel), &b = was.channels.at(channel);
        double mean = 0, difference = 0, beyond = 0;
        for (const float value : b)
            mean += std::abs(value) / static_cast<double>(b.size());
        for (std::size_t i = 0; i < b.size(); ++i) {
            const double off = std::abs(static_cast<double>(a[i] - b[i]));
            difference += off / static_cast<double>(b.size());
            if (off > kPixelTolerance * std::max<double>(std::abs(b[i]), mean)) beyond += 1;
        }
        beyond /= static_cast<double>(b.size());
        std::cout << channel << ": mean difference " << difference / mean << ", " << beyond
                  << " of the pixels beyond " << kPixelTolerance << "\n";
        EXPECT_LT(difference, kMeanTolerance * mean)
            << channel << "; where the change is meant, look at " << fresh
            << " and put it in the place of " << golden;
        EXPECT_LE(beyond, kShareBeyond) << channel;
    }
    for (const std::string& error : context.errors())
        ADD_FAILURE() << error;
}

}  // namespace
}  // namespace glowworm
