// The window where things go wrong, and what only other programs can do to it.
#include <fstream>
#include <iostream>

#include "testing.h"
#include "visit.h"
#include "x_client.h"

namespace glowworm {
namespace {

using testing::json_of;
using testing::Visit;
using testing::wait_for;

TEST(Window, TakesFilesThatAreDroppedOnIt) {
    DESKTOP_OR_SKIP();
    Visit visit({.flags = {"--bounces", "0"}});
    ASSERT_TRUE(visit.begin()) << visit.log();
    const auto drop = [&](const std::string& name) {
        return testing::drop_file(visit.desktop().display(), visit.file(name));
    };
    std::ofstream(visit.file("lamps.json"))
        << R"({"lights":[{"type":"point","name":"dropped","position":[2,2,1],
        "radiant_intensity":[1,1,1]}],"cameras":[]})";
    std::ofstream(visit.file("path.json"))
        << R"({"fps":30,"keyframes":[{"time":0,"position":[1,1,1],"look_at":[2,2,1],
        "vfov_deg":60}]})";
    std::ofstream(visit.file("notes.txt")) << "nothing that is shown";
    std::filesystem::copy_file(visit.file("room.svo"), visit.file("next door.svo"));

    ASSERT_TRUE(drop("lamps.json"));
    EXPECT_TRUE(visit.says("loaded '")) << visit.log();
    ASSERT_TRUE(drop("path.json"));
    EXPECT_TRUE(visit.says("loaded the path")) << visit.log();
    ASSERT_TRUE(drop("notes.txt"));
    EXPECT_TRUE(visit.says("is no .svo, scene or path")) << visit.log();
    visit.desktop().key("ctrl+k");
    ASSERT_TRUE(visit.wait_for_file("glowworm-path.json")) << visit.log();
    EXPECT_EQ(json_of(visit.file("glowworm-path.json"))["keyframes"].size(), 1u);
    ASSERT_TRUE(visit.save_picture(1)) << visit.log();
    EXPECT_EQ(json_of(visit.file("glowworm-1.json"))["lights"][0]["name"], "dropped");

    ASSERT_TRUE(drop("next%20door.svo"));
    EXPECT_TRUE(visit.says("light after", 2)) << "another cave: " << visit.log();
    ASSERT_TRUE(visit.desktop().focus("next door"));
    EXPECT_EQ(visit.end(), 0) << visit.log();
}

TEST(Window, KeepsItsPanelAsLargeToTheEyeOnADenseScreen) {
    DESKTOP_OR_SKIP();
    Visit visit({.flags = {"--bounces", "0"},
                 .size = "900x500",
                 .screen_width = 900,
                 .screen_height = 500,
                 .dots_per_inch = 192});
    ASSERT_TRUE(visit.begin()) << visit.log();
    // On an ordinary screen the panel ends at 330; here at 660.
    const auto inside = [&] {
        return testing::brightness(visit.desktop().display(), 350, 100, 270, 300);
    };
    const auto outside = [&] {
        return testing::brightness(visit.desktop().display(), 680, 100, 200, 300);
    };
    ASSERT_TRUE(wait_for([&] { return inside() > 0.6 * outside(); })) << "it is hidden";
    const double hidden = inside(), beside_hidden = outside();
    visit.desktop().key("Tab");
    wait_for([&] { return inside() < 0.6 * hidden; }, 20.0);
    const double shown = inside(), beside_shown = outside();
    std::cout << "under the panel " << hidden << ", with it " << shown << "; beside it "
              << beside_hidden << " and " << beside_shown << "\n";
    EXPECT_LT(shown, 0.6 * hidden);
    EXPECT_NEAR(beside_shown, beside_hidden, 0.1 * beside_hidden);
    EXPECT_EQ(visit.end(), 0);
}

TEST(Window, OutlivesALostGraphicsContext) {
    DESKTOP_OR_SKIP();
    Visit visit(
        {.flags = {"--bounces", "0"}, .environment = {"LD_PRELOAD=" GLOWWORM_RESET_DRIVER}});
    ASSERT_TRUE(visit.begin()) << visit.log();
    visit.desktop().key("b");
    visit.desktop().key("k");
    visit.desktop().drag(100, 120, 200, 120);
    ASSERT_TRUE(visit.save_picture(1)) << visit.log();
    std::ofstream(visit.file("reset")) << "now";
    EXPECT_TRUE(visit.says("the graphics driver was reset")) << visit.log();
    ASSERT_TRUE(visit.says("light after", 2)) << visit.log();
    ASSERT_TRUE(visit.desktop().focus("Glowworm"));
    ASSERT_TRUE(visit.save_picture(2)) << visit.log();
    EXPECT_EQ(json_of(visit.file("glowworm-2.json")), json_of(visit.file("glowworm-1.json")))
        << "lamps and camera";
    EXPECT_TRUE(visit.red(2) == visit.red(1)) << "the same pixels";
    visit.desktop().key("ctrl+k");
    ASSERT_TRUE(visit.wait_for_file("glowworm-path.json")) << visit.log();
    visit.desktop().key("ctrl+z");
    ASSERT_TRUE(visit.save_picture(3)) << visit.log();
    EXPECT_EQ(json_of(visit.file("glowworm-3.json"))["lights"].size(), 1u) << "undo goes on";
    EXPECT_EQ(visit.end(), 0) << visit.log();
}

TEST(Window, SaysWhatIsWrongAndStaysOpen) {
    DESKTOP_OR_SKIP();
    Visit visit({.flags = {"--bounces", "0"}, .own_scene = true});
    ASSERT_TRUE(visit.begin()) << visit.log();
    std::ofstream(visit.file("glowworm-scene.json")) << R"({"lights":[{"type":"sun")";
    visit.desktop().key("ctrl+o");
    EXPECT_TRUE(visit.says("debug: 'glowworm-scene.json'")) << visit.log();
    std::filesystem::remove(visit.file("glowworm-scene.json"));
    std::filesystem::create_directory(visit.file("glowworm-scene.json"));
    visit.desktop().key("ctrl+s");
    EXPECT_TRUE(visit.says("debug: cannot write 'glowworm-scene.json'")) << visit.log();
    visit.desktop().key("ctrl+k");
    EXPECT_TRUE(visit.says("no keyframes yet")) << visit.log();

    // Cut by another program, then gone.
    std::filesystem::resize_file(visit.file("room.svo"), 4096);
    visit.desktop().hold("w", 0.5);
    EXPECT_TRUE(visit.says("until then the picture stays as it is")) << visit.log();
    std::filesystem::remove(visit.file("room.svo"));
    visit.desktop().drag(100, 120, 150, 120);
    visit.desktop().key("F12");
    EXPECT_TRUE(visit.says("there is no picture to save")) << visit.log();
    EXPECT_GT(testing::brightness(visit.desktop().display(), 0, 0, 320, 200), 20.0);
    EXPECT_EQ(visit.end(), 0) << visit.log();
}

}  // namespace
}  // namespace glowworm
