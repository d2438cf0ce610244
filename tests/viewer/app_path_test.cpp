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

TEST(CameraPath, TurnsEvenlyHalfWayRoundBetweenTwoQuaternionsWhateverTheirSigns) {
    const double h = std::sqrt(0.5);
    // Upright cameras that look north and south: q and -q are the same turn.
    for (const char* south :
         {"[0,0.70710678118,0.70710678118,0]", "[0,-0.70710678118,-0.70710678118,0]"}) {
        const CameraPath path = path_of(
            R"({"fps":2,"keyframes":[{"time":0,"position":[0,0,0],"vfov_deg":60,"rotation":[)" +
            std::to_string(h) + ",0,0," + std::to_string(h) +
            R"(]},{"time":2,"position":[4,0,0],"vfov_deg":60,"rotation":)" + south + "}]}");
        ASSERT_EQ(frame_count(path), 5);
        for (int frame = 0; frame < 5; ++frame) {
            const Camera camera = camera_at(path, frame, {});
            const Vec3d ahead = camera.look_at - camera.position;
            EXPECT_NEAR(length(ahead), 1.0, 1e-9);
            EXPECT_NEAR(ahead.z, 0.0, 1e-6) << "level all the way";
            EXPECT_NEAR(camera.up.z, 1.0, 1e-6) << "upright all the way";
            EXPECT_NEAR(camera.position.x, frame, 1e-9);
        }
        EXPECT_NEAR(camera_at(path, 0, {}).look_at.y, 1.0, 1e-5);
        EXPECT_NEAR(std::abs(camera_at(path, 2, {}).look_at.x - 2.0), 1.0, 1e-5) << "east or west";
        EXPECT_NEAR(camera_at(path, 4, {}).look_at.y, -1.0, 1e-5);
    }
}

TEST(CameraPath, ReadsBackWhatItWrites) {
    CameraPath path{24.0, {}};
    path.keys.push_back({0.5, {1, 2, 3}, {4, 5, 6.25}, {0, 0, 1}, 55.0, false});
    path.keys.push_back({2.5, {-1, 0, 3}, {-1, 0, 2}, {0.6, 0.8, 0}, 65.0, true});
    const CameraPath again = path_of(camera_path_json(path));
    EXPECT_EQ(again.fps, 24.0);
    ASSERT_EQ(again.keys.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(again.keys[i].time, path.keys[i].time);
        EXPECT_EQ(again.keys[i].by_rotation, path.keys[i].by_rotation);
        EXPECT_EQ(again.keys[i].vfov_deg, path.keys[i].vfov_deg);
        EXPECT_EQ(again.keys[i].position, path.keys[i].position);
        EXPECT_NEAR(length(again.keys[i].look_at - path.keys[i].look_at), 0.0, 1e-9);
        EXPECT_NEAR(length(again.keys[i].up - path.keys[i].up), 0.0, 1e-9);
    }
}

TEST(CameraPath, StandsStillAtItsOnlyKey) {
    const CameraPath path = path_of(
        R"({"fps":30,"keyframes":[{"time":7,"position":[1,2,3],"look_at":[1,9,3],"vfov_deg":40}]})");
    EXPECT_EQ(frame_count(path), 1);
    EXPECT_EQ(camera_at_time(path, 99, {}).look_at, (Vec3d{1, 9, 3}));
}

TEST(CameraPath, NamesTheKeyThatIsWrong) {
    const struct {
        const char *json, *says;
    } cases[] = {
        {"[", "not a JSON object"},
        {"{}", "keyframes"},
        {R"({"fps":0,"keyframes":[1]})", "fps"},
        {R"({"fps":1e300,"keyframes":[1]})", "fps"},
        {R"({"keyframes":[{"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60}]})", "'time'"},
        {R"({"keyframes":[{"time":0,"position":[0,0,0],"look_at":[1,0,0]}]})", "vfov_deg"},
        {R"({"keyframes":[{"time":0,"position":[1e30,0,0],"look_at":[1,0,0],"vfov_deg":60}]})",
         "position"},
        {R"({"keyframes":[{"time":0,"position":[0,0,0],"rotation":[0,0,0,0],"vfov_deg":60}]})",
         "rotation"},
        {R"({"keyframes":[{"time":1,"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60},
             {"time":0.5,"position":[0,0,0],"look_at":[1,0,0],"vfov_deg":60}]})",
         "later than"},
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
