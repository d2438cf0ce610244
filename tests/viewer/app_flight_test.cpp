// Fly-throughs as users and scripts make them: videos that ffprobe counts, folders of frames.
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "analytic_cave.h"
#include "octree/build.h"
#include "octree/octree_file.h"
#include "program.h"
#include "testing.h"
#include "viewer/frame/exr.h"

namespace glowworm {
namespace {

using ::testing::ElementsAre;
using testing::Ended;
using ::testing::HasSubstr;
using testing::names_in;

struct Flight {
    testing::ScratchFolder folder;

    Flight() {
        write_octree_file(build_octree(testing::dogleg(0.08f), {.depth = 4}).view(),
                          folder / "cave.svo");
        std::ofstream(folder / "scene.json")
            << R"({"lights":[{"type":"point","name":"lamp","position":[0.5,0.5,0.5],
            "radiant_intensity":[3,3,3]}],"cameras":[{"name":"c","position":[3,0.5,0.5],
            "look_at":[0,0.5,0.5],"up":[0,0,1],"vfov_deg":70,"width":41,"height":31}]})";
        std::ofstream(folder / "path.json") << R"({"fps":10,"keyframes":[
            {"time":0,"position":[3.3,0.5,0.5],"look_at":[0,0.5,0.5],"vfov_deg":70},
            {"time":0.6,"position":[2,0.5,0.5],"rotation":[0.5,0.5,0.5,0.5],"vfov_deg":60}]})";
    }
    std::string at(const std::string& name) const { return (folder / name).string(); }
    std::vector<std::string> arguments(const std::string& output,
                                       const std::vector<std::string>& more) const {
        std::vector<std::string> words{at("cave.svo"), "--headless",
                                       "--scene",      at("scene.json"),
                                       "--path",       at("path.json"),
                                       "--samples",    "1",
                                       "--bounces",    "1",
                                       "-o",           at(output)};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
    Ended fly(const std::string& output, const std::vector<std::string>& more = {}) const {
        return testing::glowworm_view(arguments(output, more));
    }
};

bool has_ffmpeg() {
    return ::access("/usr/bin/ffmpeg", X_OK) == 0 && ::access("/usr/bin/ffprobe", X_OK) == 0;
}

/// What ffprobe says of a video's one stream.
nlohmann::json stream_of(const std::string& video) {
    const Ended probe = testing::run_program(
        "/usr/bin/ffprobe",
        {"-v", "error", "-count_frames", "-show_streams", "-of", "json", video});
    EXPECT_EQ(probe.code, 0) << probe.err;
    return nlohmann::json::parse(probe.out)["streams"][0];
}

TEST(Flight, BecomesAVideoWithAsManyFramesAsThePathHas) {
    if (!has_ffmpeg()) GTEST_SKIP() << "ffmpeg is missing: no video can be made";
    const Flight flight;
    for (const char* name : {"fly.mp4", "fly.mkv"}) {
        const Ended run = flight.fly(name, {"--json"});
        ASSERT_EQ(run.code, 0) << run.err;
        EXPECT_EQ(nlohmann::json::parse(run.out)["frames"], 7);
        const nlohmann::json stream = stream_of(flight.at(name));
        EXPECT_EQ(stream["nb_read_frames"], "7");
        EXPECT_EQ(stream["codec_name"], "h264");
        EXPECT_EQ(stream["pix_fmt"], "yuv420p");
        EXPECT_EQ(stream["avg_frame_rate"], "10/1");
        EXPECT_EQ(stream["width"], 42) << "even";
        EXPECT_EQ(stream["height"], 32) << "even";
    }
    EXPECT_EQ(flight.fly("fly.mp4").code, 7);
    EXPECT_EQ(flight.fly("fly.mp4", {"--force"}).code, 0);
    EXPECT_THAT(names_in(flight.folder.path()),
                ElementsAre("cave.svo", "fly.mkv", "fly.mp4", "path.json", "scene.json"));
}

TEST(Flight, SaysThatFfmpegIsMissingBeforeAnyWork) {
    const Flight flight;
    std::vector<std::string> arguments{"PATH=/nowhere", GLOWWORM_VIEW_PROGRAM};
    for (const std::string& word : flight.arguments("fly.mp4", {"--progress", "json"}))
        arguments.push_back(word);
    const Ended run = testing::run_program("/usr/bin/env", arguments);
    EXPECT_EQ(run.code, 2);
    EXPECT_THAT(run.err, HasSubstr("ffmpeg"));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
}

TEST(Flight, ReportsAnFfmpegThatGivesUpAndLeavesNothingBehind) {
    const Flight flight;
    std::filesystem::create_directory(flight.folder / "bin");
    std::ofstream(flight.folder / "bin/ffmpeg")
        << "#!/bin/sh\necho 'no such encoder' >&2\nexit 1\n";
    std::filesystem::permissions(flight.folder / "bin/ffmpeg", std::filesystem::perms::owner_all);
    std::vector<std::string> arguments{"PATH=" + flight.at("bin"), GLOWWORM_VIEW_PROGRAM};
    for (const std::string& word : flight.arguments("fly.mp4", {}))
        arguments.push_back(word);
    const Ended run = testing::run_program("/usr/bin/env", arguments);
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("no such encoder"));
    EXPECT_THAT(names_in(flight.folder.path()),
                ElementsAre("bin", "cave.svo", "path.json", "scene.json"));
}

TEST(Flight, BecomesNumberedFramesWhereTheOutputIsAFolder) {
    const Flight flight;
    ASSERT_EQ(flight.fly("frames").code, 0);
    const std::vector<std::string> names = names_in(flight.folder / "frames");
    ASSERT_EQ(names.size(), 7u);
    EXPECT_EQ(names.front(), "000000.png");
    EXPECT_EQ(names.back(), "000006.png");

    EXPECT_EQ(flight.fly("frames").code, 7);
    std::ofstream(flight.folder / "frames/notes.txt") << "kept";
    std::ofstream(flight.folder / "frames/000099.png") << "of a longer flight";
    ASSERT_EQ(flight.fly("frames/", {"--force", "--frame-format", "exr"}).code, 0);
    const std::vector<std::string> replaced = names_in(flight.folder / "frames");
    ASSERT_EQ(replaced.size(), 8u);
    EXPECT_EQ(replaced.front(), "000000.exr");
    EXPECT_EQ(replaced.back(), "notes.txt");
    EXPECT_EQ(read_exr(flight.folder / "frames/000003.exr").width, 41);

    std::filesystem::create_directory(flight.folder / "ready.made");
    EXPECT_EQ(flight.fly("ready.made").code, 0) << "a folder that is there and empty";
    EXPECT_EQ(names_in(flight.folder / "ready.made").size(), 7u);
}

TEST(Flight, SaysWhenGpuMemoryHasItDrawnCoarser) {
    const Flight flight;
    const auto warning = ::testing::HasSubstr("--gpu-memory has no room");
    const Ended roomy = flight.fly("roomy");
    ASSERT_EQ(roomy.code, 0) << roomy.err;
    EXPECT_THAT(roomy.err, ::testing::Not(warning));
    const Ended narrow = flight.fly("narrow", {"--gpu-memory", "10K"});
    ASSERT_EQ(narrow.code, 0) << narrow.err;
    EXPECT_THAT(narrow.err, warning);
}

TEST(Flight, RefusesWhatCannotBeAFlightsOutput) {
    const Flight flight;
    std::ofstream(flight.folder / "file") << "text";
    EXPECT_EQ(flight.fly("fly.gif").code, 2);
    EXPECT_EQ(flight.fly("file").code, 2);
    EXPECT_EQ(flight.fly("no/folder/frames").code, 3);
    EXPECT_EQ(flight.fly("fly.mp4", {"--frame-format", "exr"}).code, 2);
    EXPECT_EQ(flight.fly("frames", {"--frame-format", "exr", "--exposure", "1"}).code, 2);
    std::ofstream(flight.folder / "path.json") << "{}";
    const Ended run = flight.fly("frames", {"--progress", "json"});
    EXPECT_EQ(run.code, 3);
    EXPECT_THAT(run.err, HasSubstr("keyframes"));
    EXPECT_THAT(names_in(flight.folder.path()),
                ElementsAre("cave.svo", "file", "path.json", "scene.json"));
}

TEST(Flight, CarriesItsHeadlampAlongWhereTheSceneIsItsOwn) {
    const Flight flight;
    std::ofstream(flight.folder / "path.json") << R"({"fps":1,"keyframes":[
        {"time":0,"position":[0.5,0.5,0.5],"look_at":[9,0.5,0.5],"vfov_deg":70},
        {"time":1,"position":[3.5,2.5,0.5],"look_at":[3.5,9,0.5],"vfov_deg":70}]})";
    const Ended run = testing::glowworm_view(
        {flight.at("cave.svo"), "--headless", "--path", flight.at("path.json"), "--bounces", "0",
         "--size", "32x24", "--frame-format", "exr", "-o", flight.at("frames")});
    ASSERT_EQ(run.code, 0) << run.err;
    // Each time the wall 0.5 m beside the lamp: the same light from the same lamp.
    const auto red = [&](const char* name) {
        const ExrChannels exr = read_exr(flight.folder / "frames" / name);
        return exr.channels.at("R")[12 * 32];
    };
    EXPECT_GT(red("000001.exr"), 0.3f * red("000000.exr"));
    EXPECT_GT(red("000001.exr"), 0.01f);
}

}  // namespace
}  // namespace glowworm
