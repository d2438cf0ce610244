// Work that is cancelled at any of its reports leaves nothing behind.

#include "clouds.h"
#include "octree/build_file.h"
#include "octree/join.h"
#include "octree/octree_writer.h"
#include "octree/resident_memory.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::ScratchFolder;
using testing::sphere_cloud;

struct Cancelled {};

/// Does `work` again and again, cancelled at its first report, at one `step` reports later and so
/// on until none is left; `folder` has to be as empty as before each time. Returns how many it
/// made.
template <typename Work>
int cancel_everywhere(const std::filesystem::path& folder, int step, const Work& work) {
    for (int reports = 0;; reports += step) {
        int made = 0;
        const Progress progress = [&](std::uint64_t, std::uint64_t) {
            if (made++ == reports) throw Cancelled();
        };
        try {
            work(progress);
            return made;
        } catch (const Cancelled&) {
            EXPECT_TRUE(std::filesystem::is_empty(folder)) << "after " << reports << " reports";
        }
    }
}

SurfelStream stream_of(const SurfelCloud& cloud) {
    SurfelStream stream;
    stream.expected = cloud.surfels.size();
    stream.for_each = [&cloud](const auto& visit) { visit(cloud.surfels); };
    return stream;
}

TEST(Cancel, WritingLeavesNothingAndIsHeardEveryFewMegabytes) {
    const ScratchFolder folder;
    const std::vector<std::uint32_t> links(12u << 20, 1);  // 48 MiB
    Octree octree = build_octree(sphere_cloud(1000), {.depth = 3});
    OctreeView view = octree.view();
    view.links = links;
    view.links_per_lobe = 1;
    const int heard = cancel_everywhere(folder.path(), 1, [&](const Progress& progress) {
        write_octree_file(view, folder / "a.svo", {.progress = progress});
    });
    EXPECT_GE(heard, 6);
}

TEST(Cancel, BuildingAtOnceLeavesNothing) {
    const ScratchFolder folder;
    const SurfelCloud cloud = sphere_cloud(2000);
    const int heard = cancel_everywhere(folder.path(), 1, [&](const Progress& progress) {
        build_octree_file(stream_of(cloud), {.depth = 5}, {}, folder / "a.svo", progress);
    });
    EXPECT_GE(heard, 10);
}

TEST(Cancel, BuildingInTilesLeavesNothing) {
    const ScratchFolder folder;
    const SurfelCloud cloud = sphere_cloud(1200);  // wide discs: many leaves, more than fit
    std::uint32_t tiles = 0;
    const int heard = cancel_everywhere(folder.path(), 23, [&](const Progress& progress) {
        const MemorySettings memory{resident_bytes() + 24'000'000 + 50'000'000, folder.path()};
        tiles =
            build_octree_file(stream_of(cloud), {.depth = 10}, memory, folder / "a.svo", progress)
                .tiles;
    });
    EXPECT_GT(tiles, 1u);
    EXPECT_GE(heard, 30);
}

TEST(Cancel, JoiningLeavesNothing) {
    const ScratchFolder folder, tiles_folder;
    const SurfelCloud cloud = sphere_cloud(2000);
    BuildSettings settings{.depth = 4};
    settings.grid = build_octree(cloud, settings).grid;
    std::vector<OctreeFile> tiles;
    for (const std::uint64_t code : {0, 5}) {
        settings.tile = OctreeCell{1, code};
        const auto file = tiles_folder / ("tile" + std::to_string(code));
        write_octree_file(build_octree(cloud, settings).view(), file, {.synced = false});
        tiles.push_back(OctreeFile::open(file));
    }
    const int heard = cancel_everywhere(folder.path(), 1, [&](const Progress& progress) {
        join_octrees(tiles, {.progress = progress}, folder / "a.svo");
    });
    EXPECT_GE(heard, 8);
}

}  // namespace
}  // namespace glowworm
