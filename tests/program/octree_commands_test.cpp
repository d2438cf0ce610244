// build, join, extract, check by command: what a cluster and a person at a shell rely on.

#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>

#include "program.h"
#include "testing.h"

namespace glowworm::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// A sphere of surfels as `glowworm surface` would write it, and two broken points.
void write_surfels(const std::filesystem::path& path, std::size_t count) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << count + 2 << "\n";
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"})
        file << "property float " << name << "\n";
    file << "end_header\n";
    const auto write = [&](std::initializer_list<double> values) {
        for (const double value : values) {
            const auto v = static_cast<float>(value);
            file.write(reinterpret_cast<const char*>(&v), sizeof v);
        }
    };
    const double radius = 4.0 / std::sqrt(static_cast<double>(count));
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1.0 - 2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        const double r = std::sqrt(1.0 - z * z), angle = 2.399963 * static_cast<double>(i);
        const double x = r * std::cos(angle), y = r * std::sin(angle);
        write({2 * x, 2 * y, 2 * z, -x, -y, -z, radius});
        if (i == count / 2) {
            write({NAN, 0, 0, 0, 0, 1, radius});
            write({0, 0, 0, 0, 0, 0, radius});
        }
    }
}

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(OctreeCommands, TilesJoinToTheBytesOfOneBuild) {
    const ScratchFolder folder;
    const std::string ply = folder / "s.ply", whole = folder / "whole.svo";
    write_surfels(ply, 20000);
    ASSERT_EQ(glowworm({"build", ply, "-o", whole}).code, 0);
    const Ended plan = glowworm({"build", ply, "-o", folder / "no.svo", "--dry-run", "--json"});
    ASSERT_EQ(plan.code, 0) << plan.err;
    EXPECT_THAT(plan.out, HasSubstr("\"dropped\": 2"));
    EXPECT_FALSE(std::filesystem::exists(folder / "no.svo"));
    std::ofstream(folder / "grid.json") << plan.out;

    std::vector<std::string> join{"join"};
    for (char key = '7'; key >= '0'; --key) {
        const std::string tile = folder / (std::string("tile") + key + ".svo");
        const Ended built = glowworm({"build", ply, "--grid", folder / "grid.json", "--tile",
                                      std::string(1, key), "-o", tile});
        ASSERT_EQ(built.code, 0) << built.err;
        join.push_back(tile);
    }
    join.insert(join.end(), {"-o", folder / "joined.svo"});
    const Ended joined = glowworm(join);
    ASSERT_EQ(joined.code, 0) << joined.err;
    EXPECT_TRUE(bytes_of(whole) == bytes_of(folder / "joined.svo"));
    EXPECT_EQ(glowworm({"check", folder / "joined.svo"}).code, 0);
}

TEST(OctreeCommands, AMemoryLimitChangesNoByteAndLeavesNothingBehind) {
    const ScratchFolder folder;
    const ScratchFolder results;
    write_surfels(folder / "s.ply", 300000);
    ASSERT_EQ(glowworm({"build", folder / "s.ply", "-o", results / "a.svo"}).code, 0);
    const Ended limited = glowworm(
        {"build", folder / "s.ply", "-o", results / "b.svo", "--memory-limit", "97M", "--json"});
    ASSERT_EQ(limited.code, 0) << limited.err;
    EXPECT_THAT(limited.out, ::testing::Not(HasSubstr("\"tiles\": 0")));
    EXPECT_TRUE(bytes_of(results / "a.svo") == bytes_of(results / "b.svo"));
    const Ended small =
        glowworm({"build", folder / "s.ply", "-o", results / "c.svo", "--memory-limit", "80M"});
    EXPECT_EQ(small.code, 6) << small.err;
    EXPECT_THAT(small.err, HasSubstr("at the least"));
    EXPECT_THAT(names_in(results.path()), ElementsAre("a.svo", "b.svo"));
}

TEST(OctreeCommands, WhatIsWrongDecidesTheExitCode) {
    const ScratchFolder folder;
    const std::string ply = folder / "s.ply", svo = folder / "a.svo";
    write_surfels(ply, 2000);
    ASSERT_EQ(glowworm({"build", ply, "-o", svo}).code, 0);
    EXPECT_EQ(glowworm({"check", svo}).code, 0);
    EXPECT_EQ(glowworm({"check", ply}).code, 3) << "not an octree";
    EXPECT_EQ(glowworm({"check", folder / "absent.svo"}).code, 3);
    std::string bytes = bytes_of(svo);
    std::ofstream(folder / "longer.svo", std::ios::binary) << bytes << "xyz";
    const Ended longer = glowworm({"check", folder / "longer.svo"});
    EXPECT_EQ(longer.code, 9);
    EXPECT_THAT(longer.err, HasSubstr("3 bytes longer"));
    // An albedo's last bit: no index is wrong, only the checksum tells.
    bytes[3 * 4096 + 20] ^= 1;
    std::ofstream(folder / "bit.svo", std::ios::binary) << bytes;
    EXPECT_EQ(glowworm({"check", folder / "bit.svo"}).code, 9);
    EXPECT_EQ(glowworm({"diff", svo, folder / "bit.svo"}).code, 9);
    EXPECT_EQ(glowworm({"extract", folder / "bit.svo", "--box", "-9", "-9", "-9", "9", "9", "9",
                        "-o", folder / "cut.svo"})
                  .code,
              9);
    const auto box = [&](const std::string& x) {
        return glowworm(
                   {"extract", svo, "--box", x, "0", "0", "1", "1", "1", "-o", folder / "box.svo"})
            .code;
    };
    EXPECT_EQ(box("nan"), 2);
    EXPECT_EQ(box("2"), 2) << "lower corner above the upper";
    for (const char* depth : {"0", "22", "x"})
        EXPECT_EQ(glowworm({"build", ply, "-o", folder / "d.svo", "--depth", depth}).code, 2);
    for (const char* size : {"nan", "0", "-1", "1e-9"})
        EXPECT_EQ(glowworm({"build", ply, "-o", folder / "d.svo", "--voxel-size", size}).code, 2);
    EXPECT_EQ(glowworm({"build", ply, "-o", folder / "d.svo", "--tile", "3"}).code, 2);
}

TEST(OctreeCommands, ADepthOf21IsBuiltAndSound) {
    const ScratchFolder folder;
    write_surfels(folder / "s.ply", 20);
    const Ended built =
        glowworm({"build", folder / "s.ply", "-o", folder / "a.svo", "--depth", "21"});
    ASSERT_EQ(built.code, 0) << built.err;
    const Ended check = glowworm({"check", folder / "a.svo"});
    EXPECT_EQ(check.code, 0) << check.err;
}

TEST(OctreeCommands, LevelsAreDrawn) {
    const ScratchFolder folder;
    write_surfels(folder / "s.ply", 2000);
    ASSERT_EQ(glowworm({"build", folder / "s.ply", "-o", folder / "a.svo"}).code, 0);
    const Ended info = glowworm({"info", folder / "a.svo", "--plot", folder / "levels.png"});
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(bytes_of(folder / "levels.png").substr(0, 4), HasSubstr("PNG"));
}

}  // namespace
}  // namespace glowworm::testing
