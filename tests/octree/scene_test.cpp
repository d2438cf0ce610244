#include "octree/scene.h"

#include <fstream>

#include "octree/error.h"
#include "testing.h"

namespace glowworm {
namespace {

Scene scene_from(const std::string& json) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "scene.json") << json;
    return read_scene(folder / "scene.json");
}

std::string sentence_of(const std::string& json) {
    try {
        scene_from(json);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUnreadable);
        return error.what();
    }
    return "";
}

TEST(Scene, LightsAndCamerasArriveAsWritten) {
    const Scene scene = scene_from(R"({"extra": 1, "lights": [
        {"type":"point","name":"p","position":[1,2,3],"radiant_intensity":[4,5,6],"note":"kept"},
        {"type":"spot","name":"s","position":[0,0,0],"direction":[0,0,-2],"cone_deg":40,"blend":0.2,
         "radiant_intensity":[1,1,1]},
        {"type":"area","name":"a","corners":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],"radiance":[2,2,2]}],
      "cameras":[{"name":"c","position":[0,0,0],"look_at":[1,0,0],"up":[0,0,1],"vfov_deg":60,
                  "width":40,"height":30}]})");
    ASSERT_EQ(scene.point_lights.size(), 1u);
    EXPECT_EQ(scene.point_lights[0].position, (Vec3d{1, 2, 3}));
    ASSERT_EQ(scene.spot_lights.size(), 1u);
    EXPECT_EQ(scene.spot_lights[0].direction, (Vec3d{0, 0, -1}));
    ASSERT_EQ(scene.area_lights.size(), 1u);
    EXPECT_EQ(scene.area_lights[0].normal(), (Vec3d{0, 0, 1}));
    ASSERT_EQ(scene.cameras.size(), 1u);
    EXPECT_EQ(scene.cameras[0].height, 30);
}

TEST(Scene, AMissingKeyIsNamed) {
    EXPECT_THAT(
        sentence_of(R"({"lights":[{"type":"point","name":"lamp","position":[1,2,3]}]})"),
        ::testing::AllOf(::testing::HasSubstr("lamp"), ::testing::HasSubstr("radiant_intensity"),
                         ::testing::HasSubstr("missing")));
}

TEST(Scene, LightThatIsNoFiniteNumberIsRefusedWithASentence) {
    for (const std::string number : {"NaN", "Infinity", "-Infinity", "1e999", "1e300", "null"}) {
        const std::string lamp = R"({"lights":[{"type":"point","name":"lamp","position":[1,2,3],
            "radiant_intensity":[1,)" +
                                 number + ",1]}]}";
        EXPECT_THAT(sentence_of(lamp), ::testing::HasSubstr("finite")) << number;
        const std::string panel = R"({"lights":[{"type":"area","name":"panel",
            "corners":[[0,0,0],[1,0,0],[1,1,0],[0,1,0]],"radiance":[)" +
                                  number + ",1,1]}]}";
        EXPECT_NE(sentence_of(panel), "") << number;
    }
    EXPECT_THAT(sentence_of(R"({"lights":[{"type":"point","name":"lamp","position":[1e300,2,3],
        "radiant_intensity":[1,1,1]}]})"),
                ::testing::HasSubstr("'lamp'"));
    EXPECT_THAT(sentence_of(R"({"lights":[{"type":"point","name":"lamp","position":[1,2,3],
        "radiant_intensity":[1,-1,1]}]})"),
                ::testing::HasSubstr("negative"));
}

TEST(Scene, WhatIsNoJsonIsNamedWithItsPlace) {
    EXPECT_THAT(sentence_of("{\"lights\":[\n{\"type\":\"point\",\n\"position\":[1,NaN,2]}]}"),
                ::testing::AllOf(::testing::HasSubstr("line 3"), ::testing::HasSubstr("'NaN'")));
    EXPECT_THAT(sentence_of("{\"lights\":[{]}"), ::testing::HasSubstr("line 1"));
}

TEST(Scene, NonsenseIsRefusedWithASentence) {
    EXPECT_THAT(sentence_of("not json"), ::testing::HasSubstr("not a scene"));
    EXPECT_THAT(sentence_of(R"({"lights":[3]})"), ::testing::HasSubstr("must be an object"));
    EXPECT_THAT(sentence_of(R"({"lights":[{"type":"lava","name":"x"}]})"),
                ::testing::HasSubstr("lava"));
    EXPECT_THAT(sentence_of(R"({"cameras":[{"name":"c","position":[0,0,0],"look_at":[0,0,0],
        "up":[0,0,1],"vfov_deg":60,"width":4,"height":3}]})"),
                ::testing::HasSubstr("look_at"));
}

}  // namespace
}  // namespace glowworm
