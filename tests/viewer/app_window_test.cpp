// The window as a person uses it: a real window on a screen nobody sees, real keys and clicks.
#include <unistd.h>

#include <iostream>

#include "program.h"
#include "testing.h"
#include "viewer/frame/exr.h"
#include "visit.h"

namespace glowworm {
namespace {

using testing::Desktop;
using testing::json_of;
using testing::text_of;
using testing::Visit;
using testing::wait_for;

/// Whether two pictures are one; says how far they are apart where not.
bool same_pixels(const std::vector<float>& a, const std::vector<float>& b) {
    std::size_t differing = 0;
    float worst = 0.0f;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
        differing += a[i] != b[i] ? 1 : 0;
        worst = std::max(worst, std::abs(a[i] - b[i]));
    }
    if (differing > 0) std::cout << differing << " pixels differ, by at most " << worst << "\n";
    return a.size() == b.size() && differing == 0;
}

TEST(Window, OpensOnALitPictureWithoutASceneAndEndsAtEscape) {
    DESKTOP_OR_SKIP();
    Visit visit({.flags = {"--bounces", "0"}, .own_scene = true});
    ASSERT_TRUE(visit.begin()) << visit.log();
    EXPECT_LT(visit.log().find("the first picture after"), visit.log().find("light after"))
        << "points come before light";
    ASSERT_TRUE(visit.save_picture(1)) << visit.log();
    std::cout << "mean radiance " << visit.mean_red(1) << "\n";
    EXPECT_GT(visit.mean_red(1), 1e-3);

    visit.desktop().resize(1, 1);
    visit.desktop().resize(200, 150);
    visit.desktop().hide_for_a_moment();
    ASSERT_TRUE(visit.save_picture(2)) << visit.log();
    EXPECT_EQ(visit.red(2).size(), 200u * 150u);
    EXPECT_NEAR(visit.mean_red(2), visit.mean_red(1), 0.02 * visit.mean_red(1))
        << "the same view, as wide";
    EXPECT_EQ(visit.end(), 0) << visit.log();
}

TEST(Window, MeasuresAKnownDistanceWithinACentimetre) {
    DESKTOP_OR_SKIP();
    Visit visit({.flags = {"--bounces", "0"}});
    ASSERT_TRUE(visit.begin()) << visit.log();
    const Desktop& desktop = visit.desktop();
    // Two places on the wall 3.5 m ahead, then the walls on the left and on the right.
    desktop.key("m");
    desktop.click(110, 100);
    desktop.click(230, 150);
    desktop.key("Escape");
    desktop.key("m");
    desktop.click(10, 120);
    desktop.click(310, 120);
    desktop.key("ctrl+m");
    ASSERT_TRUE(visit.wait_for_file("glowworm-measurements.json")) << visit.log();
    const auto list = json_of(visit.file("glowworm-measurements.json"))["measurements"];
    ASSERT_EQ(list.size(), 2u);

    const double focal = Visit::kHeight / 2.0 / std::tan(M_PI / 6), depth = 3.5;
    const double truth = std::hypot(120.0, 50.0) / focal * depth;
    const double measured = list[0]["length_m"];
    const double across = double(list[1]["points"][1][0]) - double(list[1]["points"][0][0]);
    std::cout << "on the wall " << measured << " m, truth " << truth << " m; from wall to wall "
              << across << " m, truth 4 m\n";
    EXPECT_NEAR(measured, truth, 0.01);
    EXPECT_NEAR(across, 4.0, 0.01);
    EXPECT_NEAR(double(list[0]["points"][0][1]), 4.0, 0.01) << "the wall is at y = 4";
    visit.desktop().key("Escape");  // ends measuring
    EXPECT_EQ(visit.end(), 0);
}

TEST(Window, LightsUpWhereALampIsDroppedAndSavesUndoesAndReloadsTheScene) {
    DESKTOP_OR_SKIP();
    // Direct light at a given exposure: the same scene is the same pixels.
    Visit visit({.flags = {"--bounces", "0", "--exposure", "3"}, .size = "160x120"});
    ASSERT_TRUE(visit.begin()) << visit.log();
    ASSERT_TRUE(visit.save_picture(1)) << visit.log();
    visit.desktop().key("b");
    ASSERT_TRUE(visit.save_picture(2)) << visit.log();
    std::cout << "mean radiance " << visit.mean_red(1) << ", with another lamp "
              << visit.mean_red(2) << "\n";
    EXPECT_GT(visit.mean_red(2), 1.05 * visit.mean_red(1));
    EXPECT_EQ(json_of(visit.file("glowworm-2.json"))["lights"].size(), 2u);

    const std::string before = text_of(visit.file("scene.json"));
    visit.desktop().key("ctrl+s");
    ASSERT_TRUE(wait_for([&] { return text_of(visit.file("scene.json")) != before; }));
    visit.desktop().key("ctrl+z");
    ASSERT_TRUE(visit.save_picture(3)) << visit.log();
    EXPECT_TRUE(same_pixels(visit.red(3), visit.red(1))) << "undone";
    visit.desktop().key("ctrl+o");
    ASSERT_TRUE(visit.save_picture(4)) << visit.log();
    EXPECT_TRUE(same_pixels(visit.red(4), visit.red(2))) << "reloaded";
    EXPECT_TRUE(text_of(visit.file("glowworm-4.png")) == text_of(visit.file("glowworm-2.png")));
    EXPECT_EQ(visit.end(), 0);

    // Without a window the saved scene is the same picture.
    const testing::Ended run = testing::glowworm_view(
        {visit.file("room.svo"), "--headless", "--scene", visit.file("glowworm-2.json"),
         "--bounces", "0", "-o", visit.file("again.exr")});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_TRUE(same_pixels(read_exr(visit.file("again.exr")).channels.at("R"), visit.red(2)));
}

TEST(Window, FliesAndTurnsAndItsPathBecomesAVideo) {
    DESKTOP_OR_SKIP();
    Visit visit({.flags = {"--bounces", "0"}});
    ASSERT_TRUE(visit.begin()) << visit.log();
    const Desktop& desktop = visit.desktop();
    desktop.key("k");
    desktop.hold("w", 2.0);
    desktop.drag(100, 120, 200, 120);
    desktop.key("k");
    desktop.key("ctrl+k");
    ASSERT_TRUE(visit.wait_for_file("glowworm-path.json")) << visit.log();
    const auto keys = json_of(visit.file("glowworm-path.json"))["keyframes"];
    ASSERT_EQ(keys.size(), 2u);
    const double flown = double(keys[1]["position"][1]) - double(keys[0]["position"][1]);
    const double aside = double(keys[1]["look_at"][0]) - double(keys[1]["position"][0]);
    std::cout << "flown " << flown << " m north, looking " << aside << " m to the right at 3 m\n";
    EXPECT_GT(flown, 0.2);
    EXPECT_LT(flown, 3.5);
    EXPECT_NEAR(aside, 3.0 * std::sin(100 * 0.004), 0.02) << "100 pixels to the right";

    desktop.key("p");
    ASSERT_TRUE(visit.save_picture(1)) << visit.log();
    EXPECT_GT(visit.mean_red(1), 0.0) << "the plan is lit";
    EXPECT_EQ(visit.end(), 0);

    if (::access("/usr/bin/ffprobe", X_OK) != 0) GTEST_SKIP() << "ffmpeg is missing: no video";
    const testing::Ended run = testing::glowworm_view(
        {visit.file("room.svo"), "--headless", "--scene", visit.file("scene.json"), "--path",
         visit.file("glowworm-path.json"), "--bounces", "0", "--samples", "1", "--size", "32x24",
         "-o", visit.file("fly.mp4")});
    ASSERT_EQ(run.code, 0) << run.err;
    const testing::Ended probe = testing::run_program(
        "/usr/bin/ffprobe", {"-v", "error", "-count_frames", "-show_entries",
                             "stream=nb_read_frames", "-of", "csv=p=0", visit.file("fly.mp4")});
    EXPECT_EQ(probe.out, "61\n") << "two seconds at 30 frames, both ends";
}

}  // namespace
}  // namespace glowworm
