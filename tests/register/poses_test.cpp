#include "preprocess/poses.h"

#include "octree/error.h"
#include "testing.h"

namespace glowworm {
namespace {

const std::string kIdentity = "[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]";

std::string refusal(const std::string& text) {
    try {
        parse_poses(text, "poses.json");
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUnreadable);
        return error.what();
    }
    return "";
}

Scan named(const std::string& file) {
    Scan scan;
    scan.file = file;
    scan.name = scan.file.filename().string();
    return scan;
}

TEST(Poses, ComeBackToTheLastBitAfterAFile) {
    Poses poses;
    poses.origin = {500000.25, 5200000.125, 1.0 / 3.0};
    ScanPose pose;
    pose.file = "a b/scan.ply";
    pose.T_world_scan = Eigen::Translation3d(0.1, -2.0 / 7.0, 1e-9) *
                        Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    pose.status = PoseStatus::kRegistered;
    pose.weak_axes.push_back({false, {1, 0, 0}, 0.001});
    poses.scans = {pose};
    PairPose pair;
    pair.source = pair.target = pose.file;
    pair.inliers = 123;
    pair.accepted = true;
    poses.pairs = {pair};

    const testing::ScratchFolder scratch;
    write_poses(poses, scratch / "poses.json");
    const Poses back = read_poses(scratch / "poses.json");
    ASSERT_EQ(back.scans.size(), 1u);
    EXPECT_EQ(back.origin, poses.origin);
    EXPECT_EQ(back.scans[0].T_world_scan.matrix(), pose.T_world_scan.matrix());
    EXPECT_EQ(back.scans[0].status, PoseStatus::kRegistered);
    ASSERT_EQ(back.scans[0].weak_axes.size(), 1u);
    ASSERT_EQ(back.pairs.size(), 1u);
    EXPECT_EQ(back.pairs[0].inliers, 123u);
    EXPECT_TRUE(back.pairs[0].accepted);
    EXPECT_EQ(format_poses(back), format_poses(poses));
}

TEST(Poses, NeedOnlyFilesAndMatrices) {
    const Poses poses =
        parse_poses(R"({"scans":[{"file":"s.ply","T_world_scan":)" + kIdentity + "}]}", "p");
    ASSERT_EQ(poses.scans.size(), 1u);
    EXPECT_EQ(poses.scans[0].status, PoseStatus::kPrior);
}

TEST(Poses, AreRefusedWithASentenceThatNamesFileAndFault) {
    const auto with = [](const std::string& matrix) {
        return R"({"scans":[{"file":"s.ply","T_world_scan":)" + matrix + "}]}";
    };
    using ::testing::AllOf;
    using ::testing::HasSubstr;
    EXPECT_THAT(refusal("{"), AllOf(HasSubstr("poses.json"), HasSubstr("not JSON")));
    EXPECT_THAT(refusal("{}"), HasSubstr("\"scans\" is missing"));
    EXPECT_THAT(refusal("[1]"), HasSubstr("\"scans\" is missing"));
    EXPECT_THAT(refusal(R"({"scans":[{}]})"), HasSubstr("no \"file\""));
    EXPECT_THAT(refusal(R"({"scans":[{"file":"s.ply"}]})"), HasSubstr("no T_world_scan"));
    EXPECT_THAT(refusal(with("[1,2,3]")), HasSubstr("16 numbers"));
    EXPECT_THAT(refusal(with("[2,0,0,0, 0,2,0,0, 0,0,2,0, 0,0,0,1]")), HasSubstr("rigid"));
    EXPECT_THAT(refusal(with("[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]")), HasSubstr("rigid"));
    EXPECT_THAT(refusal(with("[1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,1,1]")), HasSubstr("rigid"));
    EXPECT_THAT(refusal(with(R"(["1",0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])")), HasSubstr("numbers"));
    EXPECT_THROW(read_poses("/nonexistent/poses.json"), Error);
}

TEST(Poses, AreFoundByPathAndThenByAFileNameThatIsTheOnlyOne) {
    const Poses poses = parse_poses(R"({"scans":[{"file":"a/s.ply","T_world_scan":)" + kIdentity +
                                        R"(},{"file":"b/s.ply","T_world_scan":)" + kIdentity +
                                        R"(},{"file":"t.ply","T_world_scan":)" + kIdentity + "}]}",
                                    "p");
    EXPECT_EQ(find_pose(poses, named("b/s.ply")), &poses.scans[1]);
    EXPECT_EQ(find_pose(poses, named("/data/t.ply")), &poses.scans[2]);
    EXPECT_EQ(find_pose(poses, named("c/s.ply")), nullptr) << "two have this name";
    EXPECT_EQ(find_pose(poses, named("u.ply")), nullptr);
}

TEST(Poses, NameEachScanOfAFileThatHoldsSeveral) {
    Scan scan = named("site.e57");
    EXPECT_EQ(pose_file(scan), "site.e57");
    scan.name = "site.e57#2";
    EXPECT_EQ(pose_file(scan), "site.e57#2");
}

}  // namespace
}  // namespace glowworm
