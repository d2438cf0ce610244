#include "octree/octree_file.h"

#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>
#include <random>

#include "clouds.h"
#include "octree/build.h"
#include "octree/check.h"
#include "octree/coarsen.h"
#include "octree/diff.h"
#include "octree/error.h"
#include "octree/extract.h"
#include "octree/statistics.h"
#include "octree/tables.h"
#include "testing.h"

namespace glowworm {
namespace {

using ::testing::HasSubstr;
using testing::random_cloud;
using testing::ScratchFolder;

std::string read_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

Octree small_octree() {
    return build_octree(random_cloud(200, 0.05f), {.depth = 3, .provenance = "{\"command\":1}"});
}

std::string refusal_of(const std::filesystem::path& path) {
    try {
        OctreeFile::open(path);
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUnreadable);
        return error.what();
    }
    return "";
}

template <typename T>
void expect_same(std::span<const T> a, std::span<const T> b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size_bytes()), 0);
}

TEST(OctreeFile, ComesBackAsItWasWritten) {
    const ScratchFolder folder;
    Octree octree = small_octree();
    octree.links_per_lobe = 2;
    octree.links.assign(2 * octree.lobes.size(), kNoHit);
    write_octree_file(octree.view(), folder / "a.svo");
    const OctreeFile file = OctreeFile::open(folder / "a.svo");
    const OctreeView& view = file.view();
    EXPECT_EQ(view.grid.origin, octree.grid.origin);
    EXPECT_EQ(view.grid.cube_min, octree.grid.cube_min);
    EXPECT_EQ(view.grid.depth, 3u);
    EXPECT_EQ(view.sample_count, 200u);
    EXPECT_EQ(view.bounds_max, octree.bounds_max);
    expect_same<Level>(view.levels, octree.levels);
    expect_same<Node>(view.nodes, octree.nodes);
    expect_same<NodeAttributes>(view.attributes, octree.attributes);
    expect_same<Lobe>(view.lobes, octree.lobes);
    expect_same<Chunk>(view.chunks, octree.chunks);
    expect_same<PackedSurfel>(view.surfels, octree.surfels);
    expect_same<std::uint32_t>(view.links, octree.links);
    EXPECT_EQ(view.provenance, "{\"command\":1}");
    EXPECT_EQ(read_stations(view)[2].name, "station 2");
    EXPECT_EQ(read_area_lights(view)[0].radiance, (Vec3f{3, 2, 1}));
    EXPECT_THAT(check_octree_file(folder / "a.svo"), ::testing::IsEmpty());
}

TEST(OctreeFile, WrittenTwiceIsTheSameBytes) {
    const ScratchFolder folder;
    write_octree_file(small_octree().view(), folder / "a.svo");
    write_octree_file(small_octree().view(), folder / "b.svo");
    EXPECT_EQ(read_bytes(folder / "a.svo"), read_bytes(folder / "b.svo"));
}

TEST(OctreeFile, EveryTruncationIsRefused) {
    const ScratchFolder folder;
    write_octree_file(small_octree().view(), folder / "whole.svo");
    const auto size = std::filesystem::file_size(folder / "whole.svo");
    for (std::uint64_t bytes = size; bytes-- > 0;) {
        std::filesystem::resize_file(folder / "whole.svo", bytes);
        ASSERT_NE(refusal_of(folder / "whole.svo"), "") << bytes << " of " << size << " bytes";
    }
    std::filesystem::resize_file(folder / "whole.svo", size);
    EXPECT_NE(refusal_of(folder / "whole.svo"), "") << "zeros where the bytes were";
}

TEST(OctreeFile, CutWhileMappedIsAnErrorAndNoSignal) {
    const ScratchFolder folder;
    write_octree_file(build_octree(random_cloud(20000, 0.01f), {.depth = 5}).view(),
                      folder / "a.svo");
    const OctreeFile file = OctreeFile::open(folder / "a.svo");
    EXPECT_NO_THROW(file.require_intact());
    std::filesystem::resize_file(folder / "a.svo", 8192);
    std::uint64_t sum = 0;
    for (const PackedSurfel& s : file.view().surfels)
        sum += s.normal;
    EXPECT_EQ(sum, 0u) << "what is gone reads as zeros";
    EXPECT_THROW(file.require_intact(), Error);
    EXPECT_THAT(check_structure(file.view()), ::testing::Not(::testing::IsEmpty()));
}

TEST(OctreeFile, RandomDamageBehindAValidHeaderIsHarmless) {
    const Octree octree = build_octree(random_cloud(60, 0.05f), {.depth = 2});
    std::mt19937 random(11);
    std::size_t sound = 0;
    for (int trial = 0; trial < 100000; ++trial) {
        // The sections as they would be mapped, some words of them replaced.
        Octree damaged = octree;
        const auto damage = [&](auto& records) {
            if (records.empty() || random() % 3 != 0) return;
            auto* words = reinterpret_cast<std::uint32_t*>(records.data());
            const std::size_t count = records.size() * sizeof records[0] / 4;
            const std::uint32_t values[] = {0u,
                                            1u,
                                            0xffffffffu,
                                            0x7fc00000u,
                                            words[0] + 1u,
                                            static_cast<std::uint32_t>(random())};
            words[random() % count] = values[random() % 6];
        };
        damage(damaged.levels);
        damage(damaged.nodes);
        damage(damaged.attributes);
        damage(damaged.lobes);
        damage(damaged.chunks);
        damage(damaged.surfels);
        damage(damaged.stations);
        damage(damaged.area_lights);
        const bool structure = check_structure(damaged.view()).empty();
        check_octree(damaged.view());
        read_stations(damaged.view());
        if (!structure) continue;
        // What a sound structure allows must then be possible.
        ++sound;
        measure_octree(damaged.view(), 1000);
        coarsen(damaged.view(), 1);
        extract_level(damaged.view(), 2);
        compare_octrees(octree.view(), damaged.view());
    }
    EXPECT_GT(sound, 1000u);
    EXPECT_LT(sound, 90000u);
}

TEST(OctreeFile, WhatIsNotOneSaysWhy) {
    const ScratchFolder folder;
    EXPECT_THAT(refusal_of(folder / "absent.svo"), HasSubstr("No such file"));
    EXPECT_THAT(refusal_of(folder.path()), HasSubstr("not a regular file"));
    EXPECT_THAT(refusal_of("/dev/zero"), HasSubstr("not a regular file"));
    write_bytes(folder / "empty.svo", "");
    EXPECT_THAT(refusal_of(folder / "empty.svo"), HasSubstr("not an octree"));
    write_bytes(folder / "text.svo", std::string(10000, 'x'));
    EXPECT_THAT(refusal_of(folder / "text.svo"), HasSubstr("not an octree"));

    write_octree_file(small_octree().view(), folder / "a.svo");
    std::string bytes = read_bytes(folder / "a.svo");
    bytes[8] = 99;
    write_bytes(folder / "future.svo", bytes);
    EXPECT_THAT(refusal_of(folder / "future.svo"), HasSubstr("version 99"));
    bytes[8] = static_cast<char>(kFormatVersion);
    bytes[12] = 7;
    write_bytes(folder / "damaged.svo", bytes);
    EXPECT_THAT(refusal_of(folder / "damaged.svo"), HasSubstr("checksum"));
    write_bytes(folder / "longer.svo", read_bytes(folder / "a.svo") + "x");
    EXPECT_NE(refusal_of(folder / "longer.svo"), "");
}

TEST(OctreeFile, CheckFindsAnyByteThatChanged) {
    const ScratchFolder folder;
    write_octree_file(small_octree().view(), folder / "a.svo");
    const std::string whole = read_bytes(folder / "a.svo");
    std::mt19937 random(5);
    for (int trial = 0; trial < 300; ++trial) {
        std::string bytes = whole;
        bytes[random() % bytes.size()] ^= static_cast<char>(1u << random() % 8);
        write_bytes(folder / "b.svo", bytes);
        ASSERT_THAT(check_octree_file(folder / "b.svo"), ::testing::Not(::testing::IsEmpty()));
    }
}

TEST(Check, FindsStructureThatChecksumsWouldNot) {
    const auto broken = [](auto change) {
        Octree octree = small_octree();
        change(octree);
        return check_octree(octree.view());
    };
    EXPECT_THAT(check_octree(small_octree().view()), ::testing::IsEmpty());
    EXPECT_THAT(broken([](Octree& o) { o.nodes[0].first = 5; }),
                ::testing::Contains(HasSubstr("level 0")));
    EXPECT_THAT(broken([](Octree& o) { o.nodes[1].mask ^= 1; }),
                ::testing::Contains(HasSubstr("children")));
    EXPECT_THAT(broken([](Octree& o) { o.nodes.back().mask = 4 << 8; }),
                ::testing::Contains(HasSubstr("lobes")));
    EXPECT_THAT(broken([](Octree& o) { o.levels[1].node_count = 0; }),
                ::testing::Contains(HasSubstr("levels")));
    EXPECT_THAT(broken([](Octree& o) { o.lobes[3].position[0] += 10; }),
                ::testing::Contains(HasSubstr("outside their cell")));
    EXPECT_THAT(broken([](Octree& o) { o.lobes[3].light = 2; }),
                ::testing::Contains(HasSubstr("light that is not there, first at lobe 3")));
    EXPECT_THAT(broken([](Octree& o) { o.attributes[4].opacity = NAN; }),
                ::testing::Contains(HasSubstr("opacity")));
    EXPECT_THAT(broken([](Octree& o) { o.attributes[0].area *= 2; }),
                ::testing::Contains(HasSubstr("area of what is in them")));
    EXPECT_THAT(broken([](Octree& o) { o.chunks[0].count -= 1; }),
                ::testing::Contains(HasSubstr("every point once")));
    EXPECT_THAT(broken([](Octree& o) { o.surfels[9].station_light = 3; }),
                ::testing::Contains(HasSubstr("station that is not there")));
    EXPECT_THAT(broken([](Octree& o) { o.stations[0].name_bytes = 1000; }),
                ::testing::Contains(HasSubstr("name")));
    EXPECT_THAT(broken([](Octree& o) {
                    o.links_per_lobe = 1;
                    o.links.assign(o.lobes.size(), 0);
                    o.links[2] = static_cast<std::uint32_t>(o.lobes.size());
                }),
                ::testing::Contains(HasSubstr("lobe that is not there")));
}

TEST(Statistics, CountWhatIsThere) {
    const Octree octree = small_octree();
    const OctreeStatistics s = measure_octree(octree.view(), 123456);
    EXPECT_EQ(s.samples, 200u);
    EXPECT_EQ(s.leaves, octree.levels.back().node_count);
    ASSERT_EQ(s.levels.size(), 4u);
    EXPECT_EQ(s.levels[0].nodes, 1u);
    EXPECT_DOUBLE_EQ(s.levels[0].occupied_fraction, 1.0);
    EXPECT_DOUBLE_EQ(s.levels[0].mean_children, static_cast<double>(s.levels[1].nodes));
    EXPECT_DOUBLE_EQ(s.levels[3].mean_children, 0.0);
    for (const Histogram& h : {s.samples_per_leaf, s.ndf_length, s.opacity}) {
        EXPECT_EQ(std::accumulate(h.counts.begin(), h.counts.end(), std::uint64_t{0}), s.leaves);
        EXPECT_EQ(h.edges.size(), h.counts.size() + 1);
    }
    EXPECT_NEAR(s.total_area, octree.attributes[0].area, 1e-5);
    EXPECT_EQ(s.scans[1], "station 1");
    EXPECT_EQ(s.area_lights[0], "lamp");
}

TEST(Coarsen, KeepsTotalsAndAgreesWithABuildAtThatDepth) {
    const SurfelCloud cloud = random_cloud(2000, 0.005f);
    const Octree fine = build_octree(cloud, {.depth = 6});
    const Octree coarse = coarsen(fine.view(), 4);
    const Octree truth = build_octree(cloud, {.depth = 4});
    EXPECT_EQ(coarse.grid.depth, 4u);
    ASSERT_EQ(coarse.nodes.size(), truth.nodes.size());
    for (std::size_t i = 0; i < truth.nodes.size(); ++i) {
        EXPECT_EQ(coarse.nodes[i].mask & 0xff, truth.nodes[i].mask & 0xff);
        EXPECT_NEAR(coarse.attributes[i].area / truth.attributes[i].area, 1.0, 0.05) << i;
    }
    EXPECT_NEAR(coarse.attributes[0].area / truth.attributes[0].area, 1.0, 1e-6);
    Octree whole = coarse;
    whole.surfels = fine.surfels;
    whole.chunks = fine.chunks;
    EXPECT_THAT(check_octree(whole.view()), ::testing::IsEmpty());
}

}  // namespace
}  // namespace glowworm
