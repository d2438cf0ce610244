// Lamps as they are edited, what was undone, and the scene file they are saved to.
#include <fstream>

#include "octree/scene.h"
#include "testing.h"
#include "viewer/app/history.h"
#include "viewer/app/lamps.h"
#include "viewer/app/photometry.h"

namespace glowworm {
namespace {

using ::testing::HasSubstr;

Scene scene_of_text(const std::string& text) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "scene.json") << text;
    return read_scene(folder / "scene.json");
}

constexpr const char* kScene = R"({"author":"me","lights":[
    {"type":"point","name":"p","position":[1,2,3],"radiant_intensity":[4,5,6],"maker":"x"},
    {"type":"spot","name":"s","position":[0,0,1],"direction":[0,0,-2],"cone_deg":50,"blend":0.25,
     "radiant_intensity":[0.1,0.2,0.3]},
    {"type":"area","name":"a","corners":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],"radiance":[7,8,9],
     "note":[1,2]}],
    "cameras":[{"name":"c","position":[0,0,0],"look_at":[1,0,0],"up":[0,0,1],"vfov_deg":33.3,
     "width":640,"height":480,"lens":"wide"}]})";

TEST(Lamps, GoThroughTheWindowAndBackIntoTheSameFileWithItsUnknownKeys) {
    const Scene scene = scene_of_text(kScene);
    const std::vector<Lamp> lamps = lamps_of(scene);
    ASSERT_EQ(lamps.size(), 3u);
    const std::string text = scene_json(with_lamps(scene, lamps));
    for (const char* kept : {"author", "maker", "note", "lens"})
        EXPECT_THAT(text, HasSubstr(kept));
    const Scene again = scene_of_text(text);
    EXPECT_EQ(lamps_of(again), lamps);
    EXPECT_EQ(scene_json(again), text);
    ASSERT_EQ(again.cameras.size(), 1u);
    EXPECT_EQ(again.cameras[0].vfov_deg, 33.3);
    EXPECT_EQ(again.cameras[0].width, 640);
    EXPECT_EQ(again.spot_lights[0].radiant_intensity, scene.spot_lights[0].radiant_intensity);
}

TEST(Lamps, AreDarkButThereWhenTheyAreOff) {
    const Scene scene = scene_of_text(kScene);
    std::vector<Lamp> lamps = lamps_of(scene);
    for (Lamp& lamp : lamps)
        lamp.on = false;
    const Scene dark = with_lamps(scene, lamps);
    ASSERT_EQ(dark.area_lights.size(), 1u) << "the octree's samples still name it";
    EXPECT_EQ(dark.point_lights[0].radiant_intensity, (Vec3f{}));
    EXPECT_EQ(dark.spot_lights[0].radiant_intensity, (Vec3f{}));
    EXPECT_EQ(dark.area_lights[0].radiance, (Vec3f{}));
}

TEST(Lamps, AreSavedWithTheirStrengthWhenTheyAreOffAndAreOffWhenReadBack) {
    const Scene scene = scene_of_text(kScene);
    std::vector<Lamp> lamps = lamps_of(scene);
    lamps[0].on = lamps[2].on = false;
    const Scene again = scene_of_text(scene_json(saved_with_lamps(scene, lamps)));
    EXPECT_EQ(lamps_of(again), lamps) << "their strength and unknown keys included";
    EXPECT_EQ(again.point_lights[0].radiant_intensity, (Vec3f{4, 5, 6}));
    EXPECT_EQ(with_lamps(again, lamps_of(again)).area_lights[0].radiance, (Vec3f{}));

    for (Lamp& lamp : lamps)
        lamp.on = true;
    EXPECT_EQ(scene_json(saved_with_lamps(again, lamps)), scene_json(scene)) << "switched on again";
}

TEST(Lamps, KeepAnUnknownKeyThatIsNoSwitch) {
    const Scene scene = scene_of_text(
        R"({"lights":[{"type":"point","name":"p","position":[1,2,3],"radiant_intensity":[4,5,6],
        "on":"Sundays"}]})");
    const std::vector<Lamp> lamps = lamps_of(scene);
    EXPECT_TRUE(lamps[0].on);
    EXPECT_THAT(scene_json(saved_with_lamps(scene, lamps)), HasSubstr("Sundays"));
}

TEST(Lamps, KeepTheirPowerWhenTheirColourChangesAndTheirColourWhenTheirPowerDoes) {
    for (const LampPreset& preset : lamp_presets()) {
        Lamp lamp = lamp_from(preset, {1, 2, 3}, {0, 1, 0});
        EXPECT_NEAR(power_of(lamp) * kLuminousEfficacy, preset.lumens, preset.lumens * 1e-5)
            << preset.name;
        set_color(lamp, {0.2f, 0.3f, 0.9f});
        EXPECT_NEAR(power_of(lamp) * kLuminousEfficacy, preset.lumens, preset.lumens * 1e-5);
        EXPECT_NEAR(lamp.strength.z / lamp.strength.x, 4.5, 1e-4);
        lamp.strength = strength_for(lamp, 3.0);
        EXPECT_NEAR(power_of(lamp), 3.0, 1e-5);
        EXPECT_NEAR(lamp.strength.z / lamp.strength.x, 4.5, 1e-4);
    }
    Lamp dark;
    dark.strength = {};
    EXPECT_GT(luminance_of(strength_for(dark, 1.0)), 0.0) << "white where there was no colour";
}

TEST(Lamps, GetNamesOfTheirOwn) {
    std::vector<Lamp> lamps(2);
    lamps[0].name = "spot";
    lamps[1].name = "spot 2";
    EXPECT_EQ(free_name(lamps, "spot"), "spot 3");
    EXPECT_EQ(free_name(lamps, "lamp"), "lamp");
}

TEST(History, GoesBackAndForthAndForgetsWhatWasUndoneAtANewStep) {
    History<int> history(1);
    EXPECT_FALSE(history.can_undo());
    EXPECT_EQ(history.undo(), 1);
    history.record(1);
    EXPECT_FALSE(history.can_undo()) << "nothing has changed";
    history.record(2);
    history.record(3);
    EXPECT_EQ(history.undo(), 2);
    EXPECT_EQ(history.undo(), 1);
    EXPECT_EQ(history.undo(), 1);
    EXPECT_EQ(history.redo(), 2);
    history.record(9);
    EXPECT_FALSE(history.can_redo());
    EXPECT_EQ(history.undo(), 2);
    EXPECT_EQ(history.redo(), 9);
    EXPECT_EQ(history.redo(), 9);
}

}  // namespace
}  // namespace glowworm
