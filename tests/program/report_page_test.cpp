// The page of a run that ends before there is an octree.

#include <fstream>
#include <iterator>
#include <random>

#include "preprocess/write/cloud_writer.h"
#include "program.h"
#include "testing.h"

namespace glowworm::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ReportPage, IsWrittenWhereAScanCannotBePlacedAndSaysWhichAndWhatToDo) {
    const ScratchFolder folder;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> along(-1.0f, 1.0f);
    PointCloud room, floor;
    for (int i = 0; i < 3000; ++i) {
        Vec3f p{along(random), along(random), along(random)};
        p[static_cast<int>(random() % 3)] = random() % 2 == 0 ? 1.0f : -1.0f;
        room.points.positions.push_back({3.0f * p.x, 2.0f * p.y, 1.5f * p.z});
        floor.points.positions.push_back({20.0f * along(random), 20.0f * along(random), -1.0f});
    }
    write_cloud(room, folder / "room.ply");
    write_cloud(floor, folder / "floor.ply");

    const Ended ended = glowworm({"convert", folder / "room.ply", folder / "floor.ply", "-o",
                                  folder / "cave.svo", "--report", folder / "page.html"});
    EXPECT_EQ(ended.code, 5) << ended.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "cave.svo"));
    std::ifstream stream(folder / "page.html");
    const std::string page(std::istreambuf_iterator<char>(stream), {});
    EXPECT_THAT(page, HasSubstr("There is no octree: 1 of 2 scans could not be placed"));
    EXPECT_THAT(page, HasSubstr("floor.ply"));
    EXPECT_THAT(page, HasSubstr("--allow-missing-scans"));
    EXPECT_THAT(page, HasSubstr("plan view"));
    EXPECT_THAT(page, Not(HasSubstr("Every scan is placed")));
}

}  // namespace
}  // namespace glowworm::testing
