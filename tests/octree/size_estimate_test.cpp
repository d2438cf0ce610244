#include "octree/size_estimate.h"

#include "clouds.h"
#include "octree/build.h"
#include "octree/error.h"
#include "octree/octree_file.h"
#include "testing.h"

namespace glowworm {
namespace {

using testing::ScratchFolder;
using testing::sphere_cloud;

void expect_about(double got, double truth, const std::string& what) {
    EXPECT_GT(got, 0.5 * truth) << what;
    EXPECT_LT(got, 2.0 * truth) << what;
}

TEST(SizeEstimate, IsWithinAFactorOfTwoFromCoarseLeavesToLeavesOfSinglePieces) {
    const ScratchFolder folder;
    const SurfelCloud cloud = sphere_cloud(3000);
    const CloudSummary summary = summarize(cloud.surfels);
    for (const std::uint32_t depth : {3u, 5u, 7u, 9u, 11u}) {
        const Octree octree = build_octree(cloud, {.depth = depth});
        const SizeEstimate size = estimate_size(summary, octree.grid);
        const std::string where = "depth " + std::to_string(depth);
        write_octree_file(octree.view(), folder / "a.svo");
        expect_about(size.leaves, octree.levels[depth].node_count, "leaves at " + where);
        expect_about(size.nodes, static_cast<double>(octree.nodes.size()), "nodes at " + where);
        expect_about(static_cast<double>(size.disk),
                     static_cast<double>(std::filesystem::file_size(folder / "a.svo")),
                     "bytes at " + where);
    }
}

TEST(SizeEstimate, ATreeThatNoDiskHoldsIsRefusedWithADepthThatFits) {
    CloudSummary summary = summarize(sphere_cloud(1000).surfels);
    summary.usable = 3'000'000;
    Grid grid;
    grid.cube_edge = 4.1f;
    grid.depth = 21;
    try {
        require_room(summary, grid, "a.svo");
        FAIL() << "billions of nodes are not refused";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kBudget);
        const std::string sentence = error.what();
        const std::size_t at = sentence.find("--depth ");
        ASSERT_NE(at, std::string::npos) << sentence;
        grid.depth = static_cast<std::uint32_t>(std::stoi(sentence.substr(at + 8)));
        EXPECT_NO_THROW(require_room(summary, grid, "a.svo")) << sentence;
    }
}

}  // namespace
}  // namespace glowworm
