// The viewer as users and scripts meet it: exit codes, files, one sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

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
using testing::glowworm_view;
using ::testing::HasSubstr;

std::string text_of(const std::filesystem::path& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
}

struct Cave {
    testing::ScratchFolder folder;
    std::string octree = (folder / "cave.svo").string();
    std::string scene = (folder / "scene.json").string();

    Cave() {
        write_octree_file(build_octree(testing::dogleg(0.06f), {.depth = 5}).view(), octree);
        std::ofstream(scene)
            << R"({"lights":[{"type":"point","name":"lamp","position":[0.5,0.5,0.5],
            "radiant_intensity":[3,3,3]}],"cameras":[
            {"name":"lit","position":[3.3,0.5,0.5],"look_at":[0,0.5,0.5],"up":[0,0,1],"vfov_deg":70,
             "width":40,"height":30},
            {"name":"dark","position":[3.5,2.4,0.5],"look_at":[3.5,4,0.5],"up":[0,0,1],
             "vfov_deg":70,"width":40,"height":30}]})";
    }
    std::string path(const std::string& name) const { return (folder / name).string(); }
    Ended view(std::vector<std::string> more) const {
        std::vector<std::string> arguments{octree, "--headless", "--scene", scene};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return glowworm_view(arguments);
    }
};

TEST(ViewProgram, RendersTheSameExrTwiceAndItIsBlackRoundTheBendWithoutBounces) {
    const Cave cave;
    for (const char* name : {"a.exr", "b.exr"}) {
        const Ended run = cave.view({"--camera", "dark", "--bounces", "0", "-o", cave.path(name)});
        ASSERT_EQ(run.code, 0) << run.err;
    }
    EXPECT_EQ(text_of(cave.path("a.exr")), text_of(cave.path("b.exr")));
    const ExrChannels exr = read_exr(cave.path("a.exr"));
    EXPECT_EQ(exr.width, 40);
    for (const char* channel : {"R", "direct.R", "indirect.R", "emission.R"}) {
        for (const float value : exr.channels.at(channel))
            ASSERT_EQ(value, 0.0f) << channel;
    }
    for (const float depth : exr.channels.at("Z"))
        ASSERT_GT(depth, 0.0f) << "no hole";

    ASSERT_EQ(cave.view({"--camera", "dark", "--bounces", "6", "-o", cave.path("lit.exr")}).code,
              0);
    const ExrChannels lit = read_exr(cave.path("lit.exr"));
    double sum = 0;
    for (const float value : lit.channels.at("R"))
        sum += value;
    EXPECT_GT(sum / 1200, 1e-4) << "lit after a few bounces";
    EXPECT_EQ(lit.channels.at("R"), lit.channels.at("indirect.R"));
}

TEST(ViewProgram, SaysWhatItDidAsJson) {
    const Cave cave;
    const Ended run = cave.view({"--camera", "lit", "--size", "32x24", "--bounces", "1", "--json",
                                 "--tonemap", "aces", "-o", cave.path("a.png")});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto json = nlohmann::json::parse(run.out);
    EXPECT_EQ(json["width"], 32);
    EXPECT_EQ(json["camera"], "lit");
    EXPECT_EQ(json["tonemap"], "aces");
    EXPECT_TRUE(json["exposure"].is_number());
    EXPECT_EQ(text_of(cave.path("a.png")).substr(1, 3), "PNG");
}

TEST(ViewProgram, MeasuresProbesAndComparesThemWithTheTruthTheyBring) {
    const Cave cave;
    // Right under the lamp: E = I / d^2 = 3 / 0.25.
    std::ofstream(cave.path("probes.csv"))
        << "name,px,py,pz,nx,ny,nz,E_direct_r,E_direct_g,E_direct_b,E_indirect_r,E_indirect_g,"
           "E_indirect_b\nfloor,0.5,0.5,0,0,0,1,12,12,12,0,0,0\n";
    const Ended run = cave.view({"--probes", cave.path("probes.csv"), "--bounces", "0", "--json",
                                 "-o", cave.path("out.csv")});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_LT(nlohmann::json::parse(run.out)["direct"]["worst_relative"], 1e-3);
    EXPECT_THAT(text_of(cave.path("out.csv")), HasSubstr("name,px,py,pz,nx,ny,nz,E_direct_r"));
    EXPECT_THAT(text_of(cave.path("out.csv")), HasSubstr("\nfloor,0.5,0.5,0,0,0,1,1"));
}

TEST(ViewProgram, WorksWithoutAScene) {
    const Cave cave;
    const Ended run = glowworm_view({cave.octree, "--headless", "--size", "32x24", "--bounces", "0",
                                     "-o", cave.path("start.exr")});
    ASSERT_EQ(run.code, 0) << run.err;
    double sum = 0;
    for (const float value : read_exr(cave.path("start.exr")).channels.at("R"))
        sum += value;
    EXPECT_GT(sum / 768, 1e-3) << "its own lamps light it";
}

TEST(ViewProgram, MeasuresItsPasses) {
    const Cave cave;
    const Ended run = cave.view(
        {"--camera", "lit", "--frames", "3", "--stats", cave.path("stats.json"), "--bounces", "1"});
    ASSERT_EQ(run.code, 0) << run.err;
    const auto stats = nlohmann::json::parse(text_of(cave.path("stats.json")));
    EXPECT_EQ(stats["frames"], 3);
    for (const char* pass :
         {"select", "splat depth", "splat blend", "resolve", "shade", "tone map"}) {
        ASSERT_TRUE(stats["passes"].contains(pass)) << pass;
        EXPECT_GE(stats["passes"][pass]["cpu_ms"]["max"],
                  stats["passes"][pass]["cpu_ms"]["median"]);
    }
}

TEST(ViewProgram, EndsWithTheRightCodeAndOneSentenceWhereItCannotGoOn) {
    const Cave cave;
    std::ofstream(cave.path("exists.exr")) << "old";
    std::ofstream(cave.path("text.svo")) << "not an octree";
    std::ofstream(cave.path("scene2.json"))
        << R"({"lights":[{"type":"point","name":"l","position":[0,0,0]}]})";
    const std::string frame = cave.path("new.exr");
    const struct {
        std::vector<std::string> arguments;
        int code;
        const char* says;
    } cases[] = {
        {{}, 2, "octree"},
        {{cave.octree, "--headless"}, 2, "-o"},
        {{cave.octree, "--headless", "-o", cave.path("a.jpg")}, 2, ".exr or .png"},
        {{cave.octree, "--headless", "-o", frame, "--size", "0x9"}, 2, "--size"},
        {{cave.octree, "--headless", "-o", frame, "--bounces", "-1"}, 2, "--bounces"},
        {{cave.octree, "--headless", "-o", frame, "--exposure", "1"}, 2, "for PNG"},
        {{cave.octree, "--nonsense"}, 2, "--nonsense"},
        {{cave.octree, "-o", frame}, 2, "--headless"},
        {{cave.octree, "--headless", "--scene", cave.scene, "--camera", "x", "-o", frame},
         2,
         "lit, dark"},
        {{cave.path("absent.svo"), "--headless", "-o", frame}, 3, "absent.svo"},
        {{cave.path("text.svo"), "--headless", "-o", frame}, 3, "text.svo"},
        {{cave.octree, "--headless", "--scene", cave.path("scene2.json"), "-o", frame},
         3,
         "radiant_intensity"},
        {{cave.octree, "--headless", "--probes", cave.scene, "-o", cave.path("o.csv")}, 3, "px"},
        {{cave.octree, "--headless", "-o", cave.path("no/folder/a.exr")}, 3, "no/folder"},
        {{cave.octree, "--headless", "-o", cave.path("exists.exr")}, 7, "--force"},
    };
    for (const auto& c : cases) {
        const Ended run = glowworm_view(c.arguments);
        EXPECT_EQ(run.code, c.code) << run.err;
        EXPECT_THAT(run.err, HasSubstr(c.says));
        EXPECT_EQ(run.out, "");
    }
    EXPECT_EQ(text_of(cave.path("exists.exr")), "old");
    EXPECT_THAT(testing::names_in(cave.folder.path()),
                ElementsAre("cave.svo", "exists.exr", "scene.json", "scene2.json", "text.svo"))
        << "nothing was left behind";
}

TEST(ViewProgram, OpensAWindowAndDrawsInIt) {
    if (::access("/usr/bin/xvfb-run", X_OK) != 0) {
        GTEST_SKIP() << "xvfb-run is missing: no display to open a window on";
    }
    const Cave cave;
    const Ended run = testing::run_program(
        "/usr/bin/xvfb-run",
        {"-a", "-s", "-screen 0 320x240x24", GLOWWORM_VIEW_PROGRAM, cave.octree, "--size",
         "320x240", "--frames", "5", "-v", "--scene", cave.scene});
    EXPECT_EQ(run.code, 0) << run.err << run.out;
    EXPECT_THAT(run.err + run.out, HasSubstr("the first picture after"));
}

TEST(ViewProgram, SaysThatThereIsNoDisplay) {
    const Cave cave;
    const Ended run = testing::run_program(
        "/usr/bin/env",
        {"-u", "DISPLAY", "-u", "WAYLAND_DISPLAY", GLOWWORM_VIEW_PROGRAM, cave.octree});
    EXPECT_EQ(run.code, 1);
    EXPECT_THAT(run.err, HasSubstr("--headless"));
}

}  // namespace
}  // namespace glowworm
