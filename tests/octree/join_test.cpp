#include "octree/join.h"

#include <fstream>
#include <iterator>
#include <limits>
#include <random>

#include "clouds.h"
#include "octree/build.h"
#include "octree/build_file.h"
#include "octree/check.h"
#include "octree/error.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::random_cloud;
using testing::ScratchFolder;
using testing::sphere_cloud;

std::string read_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

/// Builds the cloud at once and from all cells of `tile_level`, and compares the files.
void expect_tiles_join_to_one_build(const SurfelCloud& cloud, std::uint32_t depth,
                                    std::uint32_t tile_level) {
    const ScratchFolder folder;
    BuildSettings settings{.depth = depth};
    const Octree whole = build_octree(cloud, settings);
    write_octree_file(whole.view(), folder / "whole.svo");

    settings.grid = whole.grid;
    std::vector<OctreeFile> tiles;
    for (std::uint64_t code = 0; code < std::uint64_t{1} << 3 * tile_level; ++code) {
        settings.tile = OctreeCell{tile_level, code};
        const auto file = folder / ("tile" + std::to_string(code));
        try {
            write_octree_file(build_octree(cloud, settings).view(), file);
        } catch (const Error& error) {
            ASSERT_EQ(error.code(), ExitCode::kDegenerate);
            continue;
        }
        ASSERT_THAT(check_octree_file(file), ::testing::IsEmpty());
        tiles.push_back(OctreeFile::open(file));
    }
    EXPECT_GT(tiles.size(), 1u);
    std::shuffle(tiles.begin(), tiles.end(), std::mt19937(1));
    join_octrees(tiles, {.dropped = whole.dropped_count}, folder / "joined.svo");
    EXPECT_THAT(check_octree_file(folder / "joined.svo"), ::testing::IsEmpty());
    EXPECT_TRUE(read_bytes(folder / "whole.svo") == read_bytes(folder / "joined.svo"));
}

TEST(Join, TilesGiveTheBytesOfOneBuild) {
    expect_tiles_join_to_one_build(random_cloud(3000, 0.02f), 5, 1);
    expect_tiles_join_to_one_build(random_cloud(3000, 0.02f), 5, 2);
    expect_tiles_join_to_one_build(sphere_cloud(200000), 7, 1);
    expect_tiles_join_to_one_build(sphere_cloud(150000), 6, 2);
}

TEST(Join, TilesGiveTheBytesOfOneBuildWhereDiscsCrossThem) {
    expect_tiles_join_to_one_build(random_cloud(500, 0.3f), 5, 2);
    expect_tiles_join_to_one_build(sphere_cloud(1000), 6, 2);
}

TEST(Join, TilesAsSmallAsLeavesAndAsUnevenAsCanBe) {
    expect_tiles_join_to_one_build(random_cloud(500, 0.05f), 2, 2);
    SurfelCloud cloud = random_cloud(1000, 0.01f);
    SurfelCloud corner = random_cloud(120000, 0.001f, 2);
    for (Surfel& s : corner.surfels) {
        s.position = s.position * 0.05f + Vec3f{1.5f, 1.5f, 1.5f};
        cloud.surfels.push_back(s);
    }
    cloud.surfels[5].position.x = std::numeric_limits<float>::quiet_NaN();
    expect_tiles_join_to_one_build(cloud, 7, 2);
}

TEST(Join, TilesWhosePointsLieTooDenselyForOneChunk) {
    SurfelCloud cloud = random_cloud(1200, 0.05f);
    for (std::size_t i = 0; i < 400; ++i) {
        // Spots on the border of tiles, and inside one.
        const float centre = i % 3 == 0 ? 0.0f : i % 3 == 1 ? -1.1f : 0.7f;
        Surfel& s = cloud.surfels[i];
        s.position = s.position * 1e-4f + Vec3f{centre, centre, centre};
    }
    expect_tiles_join_to_one_build(cloud, 5, 1);
    expect_tiles_join_to_one_build(cloud, 5, 2);
    expect_tiles_join_to_one_build(cloud, 5, 3);
}

TEST(Join, TilesThatDoNotBelongTogetherAreRefused) {
    const ScratchFolder folder;
    const SurfelCloud cloud = random_cloud(1000, 0.02f);
    write_octree_file(build_octree(cloud, {.depth = 4}).view(), folder / "a.svo");
    write_octree_file(build_octree(cloud, {.depth = 5}).view(), folder / "b.svo");
    const OctreeFile a = OctreeFile::open(folder / "a.svo"), b = OctreeFile::open(folder / "b.svo");
    const auto joined = [&](std::vector<OctreeFile> tiles) {
        join_octrees(tiles, {}, folder / "joined.svo");
    };
    EXPECT_THROW(joined({}), Error);
    EXPECT_THROW(joined({a, a}), Error);
    EXPECT_THROW(joined({a, b}), Error);
    EXPECT_FALSE(std::filesystem::exists(folder / "joined.svo"));
    joined({a});
    EXPECT_EQ(read_bytes(folder / "a.svo"), read_bytes(folder / "joined.svo"));
}

SurfelStream stream_of(const SurfelCloud& cloud, std::size_t batch) {
    return {cloud.origin, cloud.stations, cloud.area_lights, [&cloud, batch](const auto& visit) {
                const std::span<const Surfel> all = cloud.surfels;
                for (std::size_t at = 0; at < all.size(); at += batch) {
                    visit(all.subspan(at, std::min(batch, all.size() - at)));
                }
            }};
}

/// Room for some 150 thousand surfels beside what this program occupies already.
std::uint64_t tight_limit() {
    std::uint64_t total = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> total >> resident;
    return resident * 4096 + 76'000'000;
}

TEST(BuildFile, GivesTheSameBytesWithinAMemoryLimit) {
    const ScratchFolder folder;
    SurfelCloud cloud = sphere_cloud(300000);
    cloud.surfels[1000].radius = 0.2f;  // one disc over many tiles
    cloud.surfels[2000].position.x = std::numeric_limits<float>::quiet_NaN();
    cloud.surfels[3000].albedo.x = 2.0f;
    cloud.surfels[4000].radius = 0.0f;
    const BuildSettings settings{.provenance = "{\"inputs\":[]}"};
    const auto report = build_octree_file(stream_of(cloud, 1000), settings, {}, folder / "a.svo");
    EXPECT_EQ(report.tiles, 0u);
    const auto limited = build_octree_file(stream_of(cloud, 777), settings,
                                           {.limit = tight_limit()}, folder / "b.svo");
    EXPECT_GT(limited.tiles, 1u);
    EXPECT_EQ(limited.dropped, 1u);
    EXPECT_THAT(check_octree_file(folder / "b.svo"), ::testing::IsEmpty());
    EXPECT_TRUE(read_bytes(folder / "a.svo") == read_bytes(folder / "b.svo"));
    std::size_t left = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path()))
        ++left;
    EXPECT_EQ(left, 2u) << "temporary files stay behind";
}

TEST(BuildFile, WhatCannotFitIsAQuestionOfBudget) {
    const ScratchFolder folder;
    SurfelCloud cloud = sphere_cloud(300000);
    const auto code_of_failure = [&] {
        try {
            build_octree_file(stream_of(cloud, 5000), {}, {.limit = tight_limit()},
                              folder / "a.svo");
        } catch (const Error& error) {
            return error.code();
        }
        return ExitCode::kDone;
    };
    for (Surfel& s : cloud.surfels)
        s.radius = 0.0f;
    EXPECT_EQ(code_of_failure(), ExitCode::kBudget);
    cloud.surfels.assign(300000, testing::surfel_at({1, 2, 3}, {0, 0, 1}, 0.01f));
    EXPECT_EQ(code_of_failure(), ExitCode::kBudget) << "all of them in one leaf";
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace glowworm
