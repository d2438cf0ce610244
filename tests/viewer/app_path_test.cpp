#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "octree/error.h"
#include "testing.h"
#include "viewer/app/camera_path.h"

namespace glowworm {
namespace {

CameraPath path_of(const std::string& json) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "path.json") << json;
    return read_camera_path(folder / "path.json");
}

TEST(CameraPath, RunsThroughItsKeysAndAlongAStraightLineEvenlyWhereTheyAreEven) {
    const CameraPath path = path_of(R"({"fps":10,"keyframes":[
        {"time":0,"position":[0,0,0],"look_at":[9,0,0],"vfov_deg":60},
        {"time":1,"position":[1,0,0],"look_at":[9,0,0],"vfov_deg":50},
        {"time":3,"position":[3,0,0],"look_at":[9,0,0],"vfov_deg":30}]})");
    ASSERT_EQ(frame_count(path), 31);
    for (int frame = 0; frame < 31; ++frame) {
        const Camera camera = camera_at(path, frame, {});
        EXPECT_NEAR(length(camera.position - Vec3d{frame / 10.0, 0, 0}), 0.0, 1e-9) << frame;
        EXPECT_NEAR(length(camera.look_at - Vec3d{9, 0, 0}), 0.0, 1e-9) << frame;
        EXPECT_NEAR(camera.vfov_deg, 60 - frame, 1e-9) << frame;
    }
}

TEST(CameraPath, TurnsByAQuaternion) {
    const double h = std::sqrt(0.5);  // a quarter turn about X: -Z becomes +Y, +Y becomes +Z
    const CameraPath path =
        path_of(R"({"keyframes":[{"time":2,"position":[1,2,3],"vfov_deg":60,"rotation":[)" +
                std::to_string(h) + ",0,0," + std::to_string(h) + "]}]}");
    ASSERT_EQ(frame_count(path), 1);
    const Camera camera = camera_at(path, 0, {});
    EXPECT_NEAR(length(camera.look_at - Vec3d{1, 3, 3}), 0.0, 1e-5);
    EXPECT_NEAR(length(camera.up - Vec3d{0, 0, 1}), 0.0, 1e-5);
}

TEST(CameraPath, NamesTheKeyThatIsWrong) {
    const struct {
        const char *json, *says;
    } cases[] = {
        {"[", "not a JSON object"},
        {"{}", "keyframes"},
        {R"({"fps":0,"keyframes":[1]})", "fps"},
        {R"({"keyframes":[{"time":0,"position":[0,0],"vfov_deg":60}]})", "position"},
        {R"({"keyframes":[{"time":0,"position":[0,0,0],"vfov_deg":60}]})", "look_at"},
        {R"({"keyframes":[{"time":0,"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60},
             {"time":0,"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60}]})",
         "keyframe 1"},
        {R"({"keyframes":[{"time":0,"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60},
             {"time":1e9,"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60}]})",
         "million"},
    };
    for (const auto& c : cases) {
        try {
            path_of(c.json);
            ADD_FAILURE() << c.json;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kUnreadable);
            EXPECT_THAT(error.what(), ::testing::HasSubstr(c.says));
        }
    }
}

}  // namespace
}  // namespace glowworm
