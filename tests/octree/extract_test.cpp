#include "octree/extract.h"

#include "clouds.h"
#include "octree/build.h"
#include "octree/check.h"
#include "octree/chunk.h"
#include "octree/diff.h"
#include "octree/error.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::random_cloud;

TEST(Extract, ALevelIsItsCellsWithWhatTheyHold) {
    const Octree octree = build_octree(random_cloud(1000, 0.02f), {.depth = 4});
    for (std::uint32_t level = 0; level <= 4; ++level) {
        const std::vector<Voxel> voxels = extract_level(octree.view(), level);
        ASSERT_EQ(voxels.size(), octree.levels[level].node_count);
        double area = 0.0;
        for (const Voxel& v : voxels) {
            area += v.area;
            const Vec3f cell = (v.centre - octree.grid.cube_min) / octree.grid.cell_edge(level);
            EXPECT_NEAR(cell.x - std::floor(cell.x), 0.5f, 1e-3f);
        }
        EXPECT_NEAR(area / octree.attributes[0].area, 1.0, 1e-6);
    }
    EXPECT_THROW(extract_level(octree.view(), 5), Error);
}

TEST(Extract, EveryPointOfALeafLevelLiesInOneOfItsVoxels) {
    const SurfelCloud cloud = random_cloud(500, 0.001f);
    const Octree octree = build_octree(cloud, {.depth = 3});
    const std::vector<Voxel> voxels = extract_level(octree.view(), 3);
    const float half = octree.grid.voxel_size() / 2;
    for (const Surfel& s : cloud.surfels) {
        EXPECT_TRUE(std::any_of(voxels.begin(), voxels.end(), [&](const Voxel& v) {
            const Vec3f d = v.centre - s.position;
            return std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) <= half * 1.0001f;
        }));
    }
}

TEST(Cut, KeepsExactlyWhatIsInTheBoxAndIsSound) {
    const SurfelCloud cloud = random_cloud(5000, 0.01f);
    const Octree octree = build_octree(cloud, {.depth = 5});
    const Box box{{-1.0f, -0.5f, -2.0f}, {0.7f, 2.0f, 1.0f}};
    const Octree part = cut_box(octree.view(), box);
    EXPECT_THAT(check_octree(part.view()), ::testing::IsEmpty());
    std::size_t inside = 0;
    for (const Surfel& s : cloud.surfels)
        inside += box.holds(s.position);
    EXPECT_NEAR(static_cast<double>(part.sample_count), static_cast<double>(inside), 2.0);
    for (const Lobe& l : part.lobes) {
        EXPECT_TRUE(box.holds({l.position[0], l.position[1], l.position[2]}));
    }
    EXPECT_THROW(cut_box(octree.view(), {{50, 50, 50}, {60, 60, 60}}), Error);
    const Octree all = cut_box(octree.view(), {{-9, -9, -9}, {9, 9, 9}});
    EXPECT_EQ(all.nodes.size(), octree.nodes.size());
    EXPECT_EQ(all.surfels.size(), octree.surfels.size());
}

TEST(Diff, ATreeDoesNotDifferFromItself) {
    const Octree octree = build_octree(random_cloud(1000, 0.02f), {.depth = 4});
    const OctreeDifference difference = compare_octrees(octree.view(), octree.view());
    EXPECT_TRUE(difference.identical());
    ASSERT_EQ(difference.levels.size(), 5u);
    EXPECT_EQ(difference.levels[4].only_a + difference.levels[4].only_b, 0u);
    EXPECT_EQ(difference.levels[4].both, octree.levels[4].node_count);
}

TEST(Diff, OneChangedAlbedoIsFoundInItsSectionAndLevels) {
    SurfelCloud cloud = random_cloud(1000, 0.02f);
    Grid grid = build_octree(cloud, {.depth = 4}).grid;
    const Octree a = build_octree(cloud, {.grid = grid});
    cloud.surfels[3].albedo = {1, 1, 1};
    const Octree b = build_octree(cloud, {.grid = grid});
    const OctreeDifference difference = compare_octrees(a.view(), b.view());
    EXPECT_THAT(difference.header, ::testing::IsEmpty());
    ASSERT_EQ(difference.sections.size(), 3u);
    EXPECT_EQ(difference.sections[0].section, "attributes");
    EXPECT_EQ(difference.sections[1].section, "lobes");
    EXPECT_EQ(difference.sections[2].section, "points");
    EXPECT_EQ(difference.sections[2].differing, 1u);
    for (const LevelDifference& level : difference.levels) {
        EXPECT_GT(level.largest_albedo, 0.0);
        EXPECT_EQ(level.largest_ndf, 0.0);
    }
}

TEST(Diff, CellsOfOnlyOneAreCounted) {
    SurfelCloud cloud = random_cloud(1000, 0.001f);
    const Octree a = build_octree(cloud, {.depth = 4});
    cloud.surfels.erase(cloud.surfels.begin() + 1, cloud.surfels.begin() + 500);
    const Octree b = build_octree(cloud, {.grid = a.grid});
    const OctreeDifference difference = compare_octrees(a.view(), b.view());
    EXPECT_FALSE(difference.identical());
    EXPECT_THAT(difference.header,
                ::testing::Contains(::testing::HasSubstr("samples: 1000 and 501")));
    EXPECT_EQ(difference.levels[4].only_b, 0u);
    EXPECT_EQ(difference.levels[4].only_a, a.levels[4].node_count - b.levels[4].node_count);
}

}  // namespace
}  // namespace glowworm
