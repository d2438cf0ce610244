// What does not fit into --memory-limit lies in files: the same bytes, under the limit.

#include <sys/resource.h>

#include <fstream>
#include <iterator>
#include <random>

#include "preprocess/write/cloud_writer.h"
#include "program.h"
#include "testing.h"

namespace glowworm::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr long kLimit = 75'000'000;
const std::string kLimitText = "75M";

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// A scanner's view of a box of 6 by 4 by 3 m, from its middle.
void write_room(const std::filesystem::path& path, std::size_t points, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> along(-1.0f, 1.0f);
    PointCloud cloud;
    for (std::size_t i = 0; i < points; ++i) {
        Vec3f p{along(random), along(random), along(random)};
        p[static_cast<int>(random() % 3)] = random() % 2 == 0 ? 1.0f : -1.0f;
        cloud.points.positions.push_back({3.0f * p.x, 2.0f * p.y, 1.5f * p.z});
    }
    write_cloud(cloud, path);
}

/// The command with and without the limit: the same bytes, and one of them below it.
void expect_same_within_limit(std::vector<std::string> words, const std::string& name) {
    const ScratchFolder free, limited;
    words.insert(words.end(), {"-o", free / name});
    const Ended without = glowworm(words);
    ASSERT_EQ(without.code, 0) << without.err;
    EXPECT_GT(without.peak, kLimit) << "the limit asks nothing of it";
    words.back() = limited / name;
    words.insert(words.end(), {"--memory-limit", kLimitText});
    const Ended within = glowworm(words);
    ASSERT_EQ(within.code, 0) << within.err;
    std::printf("%s: peak %.1f MB, under a limit of %.1f MB %.1f MB\n", words[0].c_str(),
                double(without.peak) * 1e-6, double(kLimit) * 1e-6, double(within.peak) * 1e-6);
    EXPECT_LT(within.peak, kLimit);
    EXPECT_TRUE(bytes_of(free / name) == bytes_of(limited / name));
    EXPECT_EQ(names_in(free.path()), names_in(limited.path()));
}

TEST(MemoryLimit, SurfaceKeepsToItAndMakesTheSameBytes) {
    const ScratchFolder folder;
    write_room(folder / "cloud.ply", 400'000, 1);
    expect_same_within_limit({"surface", folder / "cloud.ply"}, "surfels.ply");
}

TEST(MemoryLimit, MergeAndConvertKeepToItAndMakeTheSameBytes) {
    const ScratchFolder folder;
    for (const unsigned scan : {1u, 2u})
        write_room(folder / ("scan" + std::to_string(scan) + ".ply"), 300'000, scan);
    const std::string identity = R"("T_world_scan":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]})";
    std::ofstream(folder / "poses.json") << R"({"scans":[{"file":"scan1.ply",)" << identity
                                         << R"(,{"file":"scan2.ply",)" << identity << "]}";
    std::vector<std::string> scans;
    for (const char* name : {"scan1.ply", "scan2.ply"})
        scans.push_back(folder / name);
    const auto command = [&](const std::string& name) {
        std::vector<std::string> words{name};
        words.insert(words.end(), scans.begin(), scans.end());
        words.insert(words.end(), {"--poses", folder / "poses.json"});
        return words;
    };
    expect_same_within_limit(command("merge"), "cloud.ply");
    std::vector<std::string> convert = command("convert");
    convert.insert(convert.end(), {"--poses", "trust", "--links", "4"});
    expect_same_within_limit(convert, "cave.svo");
}

TEST(MemoryLimit, LessThanTheProgramItselfIsRefusedByEveryCommand) {
    const ScratchFolder folder;
    write_room(folder / "cloud.ply", 1'000, 1);
    const Ended refused = glowworm({"info", folder / "cloud.ply", "--memory-limit", "1M"});
    EXPECT_EQ(refused.code, 6);
    EXPECT_THAT(refused.err, HasSubstr("the program itself takes"));
    EXPECT_EQ(glowworm({"info", folder / "cloud.ply", "--memory-limit", "100M"}).code, 0);
}

TEST(MemoryLimit, WithoutOneABuildKeepsToWhatTheSystemHasLeft) {
    const ScratchFolder folder;
    write_room(folder / "cloud.ply", 600'000, 1);
    ASSERT_EQ(glowworm({"surface", folder / "cloud.ply", "-o", folder / "s.ply"}).code, 0);
    ASSERT_EQ(glowworm({"build", folder / "s.ply", "-o", folder / "a.svo"}).code, 0);
    const std::vector<std::string> words{"build", folder / "s.ply", "-o", folder / "b.svo"};
    rlimit before = {};
    ASSERT_EQ(::getrlimit(RLIMIT_DATA, &before), 0);
    const rlimit less = {180'000'000, before.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_DATA, &less), 0);  // what the program inherits
    const Ended built = glowworm(words);
    ::setrlimit(RLIMIT_DATA, &before);
    ASSERT_EQ(built.code, 0) << built.err;
    EXPECT_THAT(built.err, HasSubstr("all that the system has left"));
    EXPECT_TRUE(bytes_of(folder / "a.svo") == bytes_of(folder / "b.svo"));
}

TEST(MemoryLimit, WhatLeavesNoRoomToWorkInIsRefused) {
    const ScratchFolder folder;
    write_room(folder / "cloud.ply", 200'000, 1);
    const Ended refused = glowworm(
        {"surface", folder / "cloud.ply", "-o", folder / "s.ply", "--memory-limit", "20M"});
    EXPECT_EQ(refused.code, 6);
    EXPECT_THAT(refused.err, HasSubstr("--memory-limit"));
    EXPECT_THAT(names_in(folder.path()), ElementsAre("cloud.ply"));
}

}  // namespace
}  // namespace glowworm::testing
