#include "preprocess/read/read_scans.h"

#include <sys/stat.h>

#include "scan_text.h"

namespace glowworm {
namespace {

using testing::outcome_of;
using testing::outcome_of_reading;
using testing::scans_from;
using testing::ScratchFolder;
using testing::write_file;

std::string ply_of(const std::vector<std::string>& points) {
    std::string content = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(points.size()) +
                          "\nproperty double x\nproperty double y\nproperty double z\n"
                          "property float intensity\nend_header\n";
    for (const std::string& point : points)
        content += point + "\n";
    return content;
}

TEST(ReadScans, DropsAndCountsWhatIsNotFinite) {
    ReadReport report;
    const auto scans = scans_from(
        ply_of({"1 2 3 1", "nan 2 3 2", "1 inf 3 3", "1 2 1e999 4", "4 5 6 5"}), {}, &report);
    EXPECT_EQ(scans[0].points.intensities, (std::vector<float>{1, 5}));
    EXPECT_EQ(report.scans[0].not_finite, 3u);
    EXPECT_EQ(report.scans[0].kept, 2u);
    EXPECT_EQ(report.scans[0].declared, 5u);
}

TEST(ReadScans, DropsAndCountsNumbersThatAreNoPlaces) {
    ReadReport report;
    const auto scans = scans_from(
        ply_of({"1e30 2 3 1", "1 2 3 2", "1 -1e38 3 3", "4 5 6 4", "1 2 1.7e308 5", "1 2 2e10 6"}),
        {}, &report);
    EXPECT_EQ(scans[0].points.intensities, (std::vector<float>{2, 4}));
    EXPECT_EQ(scans[0].offset, Vec3d{}) << "the offset does not hang on them";
    EXPECT_EQ(report.scans[0].too_far, 4u);

    const auto outcome = outcome_of(ply_of({"1e30 1e30 1e30 1", "nan 0 0 1", "1e30 0 0 1"}));
    EXPECT_EQ(outcome.code, ExitCode::kDegenerate);
    EXPECT_THAT(outcome.sentence, ::testing::HasSubstr("1 not finite, 2 farther than 1e+10 m"));
}

TEST(ReadScans, OnePointAtTheOriginIsAPointTwoAreNoReturns) {
    ReadReport report;
    EXPECT_EQ(scans_from(ply_of({"1 0 0 1", "0 0 0 2", "2 0 0 3"}), {}, &report)[0].points.size(),
              3u);
    EXPECT_EQ(report.scans[0].no_return, 0u);
    const auto scans =
        scans_from(ply_of({"1 0 0 1", "0 0 0 2", "2 0 0 3", "0 0 -0 4", "0 0 0 5"}), {}, &report);
    EXPECT_EQ(scans[0].points.intensities, (std::vector<float>{1, 3}));
    EXPECT_EQ(report.scans[0].no_return, 3u);
    EXPECT_EQ(outcome_of(ply_of({"0 0 0 1", "0 0 0 1"})).code, ExitCode::kDegenerate);
}

TEST(ReadScans, LargeCoordinatesKeepTenthsOfMillimetres) {
    const auto scans = scans_from(
        ply_of({"500000.1234 5400000.4321 812.5005 1", "500100.9876 5400050.0001 800 1"}));
    const Scan& scan = scans[0];
    const Vec3d error = scan.offset + vec3_cast<double>(scan.points.positions[1]) -
                        Vec3d{500100.9876, 5400050.0001, 800};
    std::printf("error of a UTM coordinate: %g m\n", length(error));
    EXPECT_LT(length(error), 1e-4);
    EXPECT_EQ(scan.offset, (Vec3d{std::round(scan.offset.x), std::round(scan.offset.y),
                                  std::round(scan.offset.z)}));
    EXPECT_EQ(scans_from(ply_of({"999 0 0 1", "1 1 1 1"}))[0].offset, Vec3d{});
    std::vector<std::string> points(200, "1.0001 2 3 1");
    points[17] = "3000000 0 0 1";
    EXPECT_EQ(scans_from(ply_of(points))[0].offset, Vec3d{}) << "a stray point moves nothing";
}

TEST(ReadScans, PathsThatAreNoFilesGetOneSentence) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    for (const std::filesystem::path& path :
         {folder / "missing.ply", folder.path(), folder / "pipe",
          std::filesystem::path("/dev/zero"), write_file(folder / "empty.e57", ""),
          write_file(folder / "letter.txt", "Dear reader,\n"),
          write_file(folder / "poses.json", "{\"scans\":[]}")}) {
        const auto outcome = outcome_of_reading(path);
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable) << path;
        EXPECT_NE(outcome.sentence.find(path.string()), std::string::npos) << outcome.sentence;
        EXPECT_EQ(outcome.sentence.find('\n'), std::string::npos);
    }
}

TEST(ReadScans, PackedFilesAreRefusedWithTheNameOfThePacker) {
    for (const auto& [magic, name] : {std::pair{"\x1f\x8b\x08 scan", "gzip"},
                                      {"PK\x03\x04 scan", "zip"},
                                      {"BZh91AY", "bzip2"}}) {
        const auto outcome = outcome_of(magic);
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
        EXPECT_THAT(outcome.sentence, ::testing::HasSubstr(std::string("packed by ") + name));
    }
}

TEST(ReadScans, ClosedFormatsAreRefusedWithTheMenuThatExportsE57) {
    const ScratchFolder folder;
    for (const auto& [name, program] : {std::pair{"a.fls", "SCENE"},
                                        {"a.ZFS", "LaserControl"},
                                        {"a.rdbx", "RiSCAN"},
                                        {"a.rcp", "ReCap"},
                                        {"a.rcs", "ReCap"}}) {
        const auto outcome =
            outcome_of_reading(write_file(folder / name, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"));
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
        EXPECT_NE(outcome.sentence.find(program), std::string::npos) << outcome.sentence;
        EXPECT_NE(outcome.sentence.find("E57"), std::string::npos) << outcome.sentence;
    }
    // FARO's scanners write folders of that name.
    std::filesystem::create_directories(folder / "cave" / "Scan001.FLS" / "Scans");
    for (const auto& [path, named] : {std::pair{folder / "cave" / "Scan001.FLS", "Scan001.FLS"},
                                      {folder / "cave" / "Scan001.FLS" / "", "Scan001.FLS"},
                                      {folder / "cave", "Scan001.FLS"}}) {
        try {
            find_scan_files(std::vector{path});
            ADD_FAILURE() << path;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kUnreadable);
            EXPECT_THAT(error.what(), ::testing::HasSubstr("SCENE"));
            EXPECT_THAT(error.what(), ::testing::HasSubstr(named));
        }
    }
    EXPECT_THAT(outcome_of_reading(folder / "cave" / "Scan001.FLS").sentence,
                ::testing::HasSubstr("SCENE"));
    EXPECT_EQ(outcome_of_reading(write_file(folder / "really_a_ply.fls", ply_of({"1 2 3 4"}))).code,
              ExitCode::kDone);
}

TEST(FindScanFiles, ExpandsFoldersInNaturalOrderAndSkipsWhatIsNoScan) {
    const ScratchFolder folder;
    for (const char* name : {"scan10.ply", "scan2.ply", "scan1.dat"})
        write_file(folder / name, ply_of({"1 2 3 4"}));
    write_file(folder / "poses.json", "{}");
    write_file(folder / "notes.txt", "12\n15\n99\n");
    write_file(folder / ".hidden.ply", ply_of({"1 2 3 4"}));
    std::filesystem::create_directory(folder / "deeper");
    write_file(folder / "deeper" / "scan3.ply", ply_of({"1 2 3 4"}));
    const std::filesystem::path inputs[] = {folder / "deeper/scan3.ply", folder.path()};
    EXPECT_THAT(find_scan_files(inputs),
                ::testing::ElementsAre(folder / "deeper/scan3.ply", folder / "scan1.dat",
                                       folder / "scan2.ply", folder / "scan10.ply"));
}

ExitCode code_of_finding(const std::vector<std::filesystem::path>& inputs) {
    try {
        find_scan_files(inputs);
    } catch (const Error& error) {
        return error.code();
    }
    return ExitCode::kDone;
}

TEST(FindScanFiles, RefusesFoldersWithoutScansMissingPathsAndTheSameFileTwice) {
    const ScratchFolder folder;
    EXPECT_EQ(code_of_finding({folder.path()}), ExitCode::kUnreadable);
    EXPECT_EQ(code_of_finding({folder / "missing"}), ExitCode::kUnreadable);
    const auto scan = write_file(folder / "a.ply", ply_of({"1 2 3 4"}));
    EXPECT_EQ(code_of_finding({scan}), ExitCode::kDone);
    EXPECT_EQ(code_of_finding({scan, folder.path()}), ExitCode::kUsage);
    EXPECT_EQ(code_of_finding({scan, folder / "." / "a.ply"}), ExitCode::kUsage);
}

}  // namespace
}  // namespace glowworm
