#include "preprocess/register/plan_view.h"

#include <fstream>

#include "octree/error.h"
#include "two_chamber_site.h"

namespace glowworm {
namespace {

using namespace testing;

constexpr int kSameRow = 24, kFirstRow = 30;  // of the legend's discs, pixels
constexpr int kDisc = 9;                      // pixels at least that a disc is wide

bool is_grey(const Rgb8& c) {
    return c.r == c.g && c.g == c.b;
}

/// The column where the legend's disc of a scan ends; -1 where there is none.
int legend_disc(const Picture& picture, int row) {
    for (int x = picture.width - 1, run = 0; x > 0; --x) {
        const bool same = picture.at(x, row) == picture.at(x - 1, row);
        run = same && !is_grey(picture.at(x, row)) ? run + 1 : 0;
        if (run >= kDisc) return x;
    }
    return -1;
}

/// The middle of what has that colour left of `end`, and how many pixels it is.
Eigen::Vector2d middle_of(const Picture& picture, const Rgb8& colour, int end, int& count) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    count = 0;
    for (int y = 0; y < picture.height; ++y) {
        for (int x = 0; x < end; ++x) {
            if (picture.at(x, y) != colour) continue;
            sum += Eigen::Vector2d(x, -y);
            ++count;
        }
    }
    return sum / std::max(count, 1);
}

Poses true_poses(const Site& site) {
    Poses poses;
    for (std::size_t i = 0; i < site.scans.size(); ++i) {
        ScanPose& pose = poses.scans.emplace_back();
        pose.file = pose_file(site.scans[i]);
        pose.T_world_scan = site.truth[i];
        pose.status = PoseStatus::kRegistered;
    }
    return poses;
}

TEST(PlanView, StationsLieWhereTheyAreAndInTheLegend) {
    const Site site = two_chamber_site();
    const Picture picture = draw_plan_view(site.scans, true_poses(site), 1000);
    std::vector<Eigen::Vector2d> discs;
    for (int s = 0; s < static_cast<int>(site.scans.size()); ++s) {
        const int row = kFirstRow + s * kSameRow, at = legend_disc(picture, row);
        ASSERT_GT(at, 0) << "scan " << s << " is not in the legend";
        int count = 0;
        discs.push_back(middle_of(picture, picture.at(at, row), at - 2 * kDisc, count));
        EXPECT_GE(count, 30) << "the disc of scan " << s;
    }
    const auto station = [&](std::size_t i) -> Eigen::Vector2d {
        return site.truth[i].translation().head<2>();
    };
    const double scale =
        (discs.back() - discs.front()).norm() / (station(discs.size() - 1) - station(0)).norm();
    for (std::size_t i = 0; i < discs.size(); ++i) {
        const Eigen::Vector2d expected = discs[0] + scale * (station(i) - station(0));
        const double off = (discs[i] - expected).norm();
        std::printf("station %zu: %.1f pixels off at %.1f pixels a metre\n", i, off, scale);
        EXPECT_LT(off, 3.0) << "station " << i;
    }
}

TEST(PlanView, AScanThatIsNotPlacedIsNamedAndNotDrawn) {
    const Site site = two_chamber_site();
    Poses poses = true_poses(site);
    const Picture all = draw_plan_view(site.scans, poses, 400);
    for (std::size_t i = 1; i < poses.scans.size(); ++i)
        poses.scans[i].status = PoseStatus::kUnregistered;
    const Picture one = draw_plan_view(site.scans, poses, 400);
    const auto red = [](const Picture& picture) {
        return std::ranges::count(picture.pixels, Rgb8{255, 96, 96});
    };
    EXPECT_EQ(red(all), 0);
    EXPECT_GT(red(one), 100);
    poses.scans[0].status = PoseStatus::kUnregistered;
    EXPECT_THROW(draw_plan_view(site.scans, poses), Error);
}

TEST(PlanView, IsWrittenAsAPng) {
    const Site site = two_chamber_site();
    const ScratchFolder scratch;
    write_plan_view(site.scans, true_poses(site), scratch / "plan.png", 400);
    std::ifstream stream(scratch / "plan.png", std::ios::binary);
    std::string magic(8, '\0');
    stream.read(magic.data(), 8);
    EXPECT_EQ(magic, "\x89PNG\r\n\x1a\n");
}

}  // namespace
}  // namespace glowworm
