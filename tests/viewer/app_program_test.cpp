// The viewer as users and scripts meet it: exit codes, files, one sentence.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "analytic_cave.h"
#include "octree/build.h"
#include "octree/coarsen.h"
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

double mean_red(const std::filesystem::path& exr) {
    const std::vector<float> red = read_exr(exr).channels.at("R");
    return std::accumulate(red.begin(), red.end(), 0.0) / static_cast<double>(red.size());
}

TEST(ViewProgram, GathersLightRoundTheBendByConesAboutAsBrightAsAlongLinks) {
    const Cave cave;
    const auto round_the_bend = [&](const std::string& name, std::vector<std::string> more) {
        std::vector<std::string> arguments{"--camera", "dark", "--bounces",    "6",
                                           "--json",   "-o",   cave.path(name)};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const Ended run = cave.view(arguments);
        EXPECT_EQ(run.code, 0) << run.err;
        const auto json = nlohmann::json::parse(run.out);
        EXPECT_EQ(json.contains("cones"), !more.empty());
        EXPECT_EQ(json.contains("links"), more.empty());
        return mean_red(cave.path(name));
    };
    const double links = round_the_bend("links.exr", {});
    const double few = round_the_bend("few.exr", {"--cones", "6"});
    const double many = round_the_bend("many.exr", {"--cones", "16"});
    const double faithful = round_the_bend("faithful.exr", {"--faithful"});
    std::cout << "mean radiance round the bend: links " << links << ", 6 cones " << few
              << ", 16 cones " << many << ", faithful " << faithful << "\n";
    // Six wide cones see past the edge of the bend: 2.8 times the light where it is this dark.
    EXPECT_GT(few, links / 2);
    EXPECT_LT(few, links * 4);
    EXPECT_GT(many, links / 2);
    EXPECT_LT(many, links * 2);
    EXPECT_NE(few, many);
    EXPECT_GT(faithful, 0.0);
    EXPECT_NE(faithful, few);
}

TEST(ViewProgram, SimulatesLightOnCoarserLeavesButDrawsTheSamePoints) {
    const Cave cave;
    const Ended fine = cave.view({"--camera", "lit", "--bounces", "2", "--light-depth", "5",
                                  "--json", "-o", cave.path("fine.exr")});
    const Ended coarse = cave.view({"--camera", "lit", "--bounces", "2", "--light-depth", "4",
                                    "--json", "-o", cave.path("coarse.exr")});
    ASSERT_EQ(fine.code, 0) << fine.err;
    ASSERT_EQ(coarse.code, 0) << coarse.err;
    EXPECT_EQ(nlohmann::json::parse(fine.out)["light_depth"], 5);
    EXPECT_EQ(nlohmann::json::parse(coarse.out)["light_depth"], 4);
    const ExrChannels a = read_exr(cave.path("fine.exr")), b = read_exr(cave.path("coarse.exr"));
    EXPECT_EQ(a.channels.at("Z"), b.channels.at("Z"));
    EXPECT_EQ(a.channels.at("albedo.R"), b.channels.at("albedo.R"));
    EXPECT_NE(a.channels.at("indirect.R"), b.channels.at("indirect.R"));
    const double ratio = mean_red(cave.path("coarse.exr")) / mean_red(cave.path("fine.exr"));
    std::cout << "radiance at depth 4 over depth 5: " << ratio << "\n";
    EXPECT_NEAR(ratio, 1.0, 0.1);
}

TEST(ViewProgram, SimulatesLightOnGroupsOfLobesAtTheDeepestLevelThatFitsItsMemory) {
    const Cave cave;
    const auto levels = [&](const char* memory) {
        return cave.view({"--camera", "lit", "--bounces", "1", "--light-memory", memory, "--json",
                          "-o", cave.path(std::string(memory) + ".exr")});
    };
    const Ended all = levels("1G"), groups = levels("1M"), less = levels("400k"),
                none = levels("1k");
    ASSERT_EQ(all.code, 0) << all.err;
    EXPECT_EQ(nlohmann::json::parse(all.out)["light_depth"], 5);
    EXPECT_FALSE(nlohmann::json::parse(all.out).contains("light_groups"));
    EXPECT_THAT(all.err, ::testing::Not(HasSubstr("--light-memory")));
    ASSERT_EQ(groups.code, 0) << groups.err;
    EXPECT_GT(nlohmann::json::parse(groups.out)["light_groups"], 0);
    EXPECT_THAT(groups.err, HasSubstr("light is simulated on at most"));
    ASSERT_EQ(less.code, 0) << less.err;
    EXPECT_LT(nlohmann::json::parse(less.out)["light_depth"], 5);
    EXPECT_THAT(less.err, HasSubstr("light is simulated"));
    EXPECT_EQ(none.code, 6);
    EXPECT_THAT(none.err, HasSubstr("--light-memory"));
}

TEST(ViewProgram, RefusesAnOctreeWhoseIndicesLeadOutside) {
    const Cave cave;
    const OctreeFile sound = OctreeFile::open(cave.octree);
    const auto refused = [&](const char* what, const auto& spoil) {
        Octree octree = coarsen(sound.view(), sound.view().grid.depth);
        octree.chunks.assign(sound.view().chunks.begin(), sound.view().chunks.end());
        octree.surfels.assign(sound.view().surfels.begin(), sound.view().surfels.end());
        spoil(octree);
        const std::string path = cave.path("hostile.svo");
        write_octree_file(octree.view(), path);
        const Ended run = glowworm_view({path, "--headless", "-o", cave.path("hostile.exr")});
        EXPECT_EQ(run.code, 3) << what << ": " << run.err;
        EXPECT_THAT(run.err, HasSubstr("is damaged")) << what;
        EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << what;
        EXPECT_FALSE(std::filesystem::exists(cave.path("hostile.exr"))) << what;
    };
    refused("a child", [](Octree& octree) { octree.nodes[0].first = 0x7fffffff; });
    refused("a leaf's lobes", [](Octree& octree) { octree.nodes.back().first = 0x7fffffff; });
    refused("a chunk", [](Octree& octree) { octree.chunks.back().first = 0x7fffffff; });
    refused("a lobe's light", [](Octree& octree) { octree.lobes[0].light = 7; });
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
    const ExrChannels exr = read_exr(cave.path("start.exr"));
    double sum = 0;
    for (const float value : exr.channels.at("R"))
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
    for (const char* pass : {"select", "splat depth", "splat blend", "shade", "tone map"}) {
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
        {{cave.octree, "--headless", "-o", frame, "--cones", "7"}, 2, "--cones"},
        {{cave.octree, "--headless", "-o", frame, "--cones", "9", "--faithful"}, 2, "--faithful"},
        {{cave.octree, "--headless", "-o", frame, "--light-depth", "6"}, 2, "which is 5"},
        {{cave.octree, "--headless", "-o", frame, "--light-depth", "0"}, 2, "--light-depth"},
        {{cave.octree, "--headless", "-o", cave.path("a.png"), "--exposure", "nan"}, 2, "'nan'"},
        {{cave.octree, "--headless", "-o", frame, "--wetness", "nan"}, 2, "--wetness"},
        {{cave.octree, "--headless", "-o", frame, "--quality", "-inf"}, 2, "--quality"},
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
