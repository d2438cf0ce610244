// The main job on the bundled scans, as users run it: six stations, each in its own frame, no poses
// given; then light round a bend.

#include <Eigen/Geometry>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "program.h"
#include "testing.h"
#include "viewer/frame/exr.h"

namespace glowworm::testing {
namespace {

using Json = nlohmann::json;

const std::string kDemo = GLOWWORM_ROOT "/demo";

/// Converts the demo's scans once for all tests of this file.
struct DemoCave {
    ScratchFolder folder;
    std::string svo = folder / "cave.svo";
    Ended converted = glowworm({"convert", kDemo + "/scans", "-o", svo, "--json"});

    static const DemoCave& get() {
        static const DemoCave cave;
        return cave;
    }

    /// Mean of R, G, B over the frame of a camera.
    double brightness(const std::string& camera, const std::vector<std::string>& more) const {
        const std::string frame = folder / (camera + ".exr");
        std::vector<std::string> words = {
            svo,        "--headless", "--scene", kDemo + "/scene.json",
            "--camera", camera,       "--size",  "96x72",
            "-o",       frame,        "--force"};
        words.insert(words.end(), more.begin(), more.end());
        const Ended ended = glowworm_view(words);
        EXPECT_EQ(ended.code, 0) << ended.err;
        const ExrChannels exr = read_exr(frame);
        double sum = 0.0;
        for (const char* channel : {"R", "G", "B"}) {
            for (const float value : exr.channels.at(channel))
                sum += value;
        }
        return sum / (3.0 * double(exr.channels.at("R").size()));
    }
};

Eigen::Isometry3d pose_of(const Json& scan) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 16; ++i)
        pose.matrix()(i / 4, i % 4) = scan["T_world_scan"][std::size_t(i)];
    return pose;
}

TEST(DemoCave, ConvertsInOneCommandAndSaysWhatItMade) {
    const DemoCave& cave = DemoCave::get();
    ASSERT_EQ(cave.converted.code, 0) << cave.converted.err;
    const Json result = Json::parse(cave.converted.out);
    EXPECT_EQ(result["scans"], 6);
    EXPECT_EQ(result["registered"], 6);
    EXPECT_THAT(names_in(cave.folder.path()),
                ::testing::IsSupersetOf({"cave.svo", "cave.svo.poses.json"}));
    EXPECT_TRUE(cave.converted.err.ends_with(cave.svo + "\n")) << cave.converted.err;

    const Json info = Json::parse(glowworm({"info", cave.svo, "--json"}).out);
    EXPECT_EQ(info["scans"].size(), 6u);
    EXPECT_EQ(info["levels"].size(), info["depth"].get<std::size_t>() + 1);
    EXPECT_EQ(info["provenance"]["inputs"].size(), 6u);
    EXPECT_EQ(glowworm({"check", cave.svo}).code, 0);
}

TEST(DemoCave, EveryStationIsFoundWhereItStood) {
    const DemoCave& cave = DemoCave::get();
    ASSERT_EQ(cave.converted.code, 0) << cave.converted.err;
    const Json found = Json::parse(std::ifstream(cave.svo + ".poses.json"));
    const Json truth = Json::parse(std::ifstream(kDemo + "/true_poses.json"));
    ASSERT_EQ(found["scans"].size(), truth["scans"].size());
    for (std::size_t i = 0; i < truth["scans"].size(); ++i) {
        const Eigen::Isometry3d error =
            pose_of(truth["scans"][i]).inverse() * pose_of(found["scans"][i]);
        const double degrees = Eigen::AngleAxisd(error.linear()).angle() * 180.0 / std::numbers::pi;
        const double millimetres = error.translation().norm() * 1e3;
        std::printf("%s: %.3f degrees, %.1f mm\n",
                    truth["scans"][i]["file"].get<std::string>().c_str(), degrees, millimetres);
        EXPECT_LT(degrees, 0.1);
        EXPECT_LT(millimetres, 10.0);
    }
}

TEST(DemoCave, TheSameScansGiveTheSameBytesOnOneThread) {
    const DemoCave& cave = DemoCave::get();
    ASSERT_EQ(cave.converted.code, 0) << cave.converted.err;
    const ScratchFolder again;
    ASSERT_EQ(
        glowworm({"convert", kDemo + "/scans", "-o", again / "cave.svo", "--threads", "1"}).code,
        0);
    const auto bytes = [](const std::filesystem::path& path) {
        std::ifstream stream(path, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    EXPECT_TRUE(bytes(cave.svo) == bytes(again / "cave.svo"));
}

TEST(DemoCave, RoundTheBendItIsBlackUntilTheLightBounces) {
    const DemoCave& cave = DemoCave::get();
    ASSERT_EQ(cave.converted.code, 0) << cave.converted.err;
    const double chamber = cave.brightness("chamber", {"--bounces", "0"});
    const double direct = cave.brightness("round_the_bend", {"--bounces", "0"});
    const double bounced = cave.brightness("round_the_bend", {"--bounces", "8"});
    const double more = cave.brightness("round_the_bend", {"--converge"});
    std::printf(
        "mean radiance: chamber, direct %.4g; round the bend, direct %.4g, 8 bounces %.4g, "
        "converged %.4g\n",
        chamber, direct, bounced, more);
    EXPECT_GT(chamber, 0.1);
    EXPECT_LT(direct, 0.01 * bounced);
    EXPECT_GT(bounced, 1e-3 * chamber);
    EXPECT_GT(more, bounced);
}

}  // namespace
}  // namespace glowworm::testing
