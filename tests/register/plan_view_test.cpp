#include "preprocess/register/plan_view.h"
#include "two_chamber_site.h"

namespace glowworm {
namespace {

using namespace testing;

TEST(PlanView, IsAPictureOfTheStationsAndTheirScans) {
    Site site = two_chamber_site();
    Registration result;
    for (std::size_t i = 0; i < site.scans.size(); ++i) {
        ScanPose pose;
        pose.file = pose_file(site.scans[i]);
        pose.T_world_scan = site.truth[i];
        pose.status = PoseStatus::kRegistered;
        result.poses.scans.push_back(pose);
    }
    const testing::ScratchFolder scratch;
    write_plan_view(site.scans, result.poses, scratch / "plan.png", 400);
    EXPECT_GT(std::filesystem::file_size(scratch / "plan.png"), 1000u);
}

}  // namespace
}  // namespace glowworm
