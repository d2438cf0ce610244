#include <clocale>

#include "scan_text.h"

namespace glowworm {
namespace {

using testing::outcome_of;
using testing::scans_from;

/// The same three points however they are written: x = 1.5, 2.5, 3.5; y = -2; z = 10, 20, 30.
void expect_three_points(const std::string& content, const ReadSettings& settings = {}) {
    ReadReport report;
    const auto scans = scans_from(content, settings, &report);
    ASSERT_EQ(scans.size(), 1u) << content;
    ASSERT_EQ(scans[0].points.size(), 3u) << content;
    EXPECT_EQ(scans[0].points.positions[2], (Vec3f{3.5f, -2.0f, 30.0f})) << content;
    ASSERT_EQ(report.notes.size(), 1u);
    std::printf("%s\n", report.notes[0].c_str());
}

std::string utf16(std::string_view text, bool big) {
    std::string bytes = big ? "\xfe\xff" : "\xff\xfe";
    for (const char c : text)
        bytes += big ? std::string{'\0', c} : std::string{c, '\0'};
    return bytes;
}

TEST(TextTable, DelimitersAndDecimalSignsAreWorkedOut) {
    expect_three_points("1.5 -2 10\n2.5 -2 20\n3.5 -2 30\n");
    expect_three_points("  1.5\t -2   10\n2.5 -2 20  \n3.5 -2 30");
    expect_three_points("1.5,-2,10\n2.5,-2,20\n3.5,-2,30\n");
    expect_three_points("1.5, -2, 10,\n2.5, -2, 20,\n3.5, -2, 30,\n");
    expect_three_points("1.5;-2;10\n2.5;-2;20\n3.5;-2;30\n");
    expect_three_points("1,5;-2;10\n2,5;-2;20\n3,5;-2;30\n");
    expect_three_points("1,5 -2,0 10,0\n2,5 -2,0 20,0\n3,5 -2,0 30,0\n");
    expect_three_points("1,5\t-2\t10\n2,5\t-2\t20\n3,5\t-2\t30\n");
    expect_three_points("+1.5e0 -2 1e1\n2.5 -2 20\n3.5 -2 3E+01\n");
}

TEST(TextTable, HeadersCommentsLineEndsAndMarksArePassedOver) {
    const std::string plain = "X Y Z\n1.5 -2 10\n2.5 -2 20\n3.5 -2 30\n";
    expect_three_points(plain);
    expect_three_points("\xef\xbb\xbf" + plain);
    expect_three_points(utf16(plain, false));
    expect_three_points(utf16(plain, true));
    expect_three_points("X Y Z\r\n1.5 -2 10\r\n2.5 -2 20\r\n3.5 -2 30\r\n");
    expect_three_points("X Y Z\r1.5 -2 10\r2.5 -2 20\r3.5 -2 30\r");
    expect_three_points(
        "# made by hand\n\n//X Y Z\n1.5 -2 10\n\n2.5 -2 20\n# half way\n3.5 -2 30\n");
    expect_three_points("\"x\",\"y\",\"z\"\n\"1.5\",\"-2\",\"10\"\n2.5,-2,20\n3.5,-2,30\n");
}

TEST(TextTable, AHeaderPutsColumnsInAnyOrder) {
    const auto scans = scans_from(
        "id;Z;Y;X;Intensity;R;G;B;Nx;Ny;Nz;class\n1;10;-2;1.5;7;255;0;3;0;0;1;wall\n"
        "2;20;-2;2.5;8;0;128;0;1;0;0;floor\n");
    const Points& points = scans[0].points;
    EXPECT_EQ(points.positions[1], (Vec3f{2.5f, -2.0f, 20.0f}));
    EXPECT_EQ(points.intensities, (std::vector<float>{7, 8}));
    EXPECT_EQ(points.colours[0], (Rgb8{255, 0, 3}));
    EXPECT_EQ(points.normals[1], (Vec3f{1, 0, 0}));
}

TEST(TextTable, WithoutAHeaderTheValuesSayWhatTheyAre) {
    const auto colours_last = scans_from("1 2 3 -900 10 20 30\n2 3 4 -901 11 21 31\n");
    EXPECT_EQ(colours_last[0].points.intensities[1], -901.0f);
    EXPECT_EQ(colours_last[0].points.colours[1], (Rgb8{11, 21, 31}));
    const auto colours_first = scans_from("1 2 3 10 20 30 0.5\n2 3 4 11 21 31 0.75\n");
    EXPECT_EQ(colours_first[0].points.intensities[1], 0.75f);
    EXPECT_EQ(colours_first[0].points.colours[1], (Rgb8{11, 21, 31}));
    const auto normals = scans_from("1 2 3 0 0.6 0.8\n2 3 4 1 0 0\n");
    EXPECT_EQ(normals[0].points.normals[0], (Vec3f{0.0f, 0.6f, 0.8f}));
    EXPECT_TRUE(normals[0].points.colours.empty());
    const auto all = scans_from("1 2 3 255 0 0 0 0 1 4.5\n2 3 4 0 255 0 1 0 0 5.5\n");
    EXPECT_EQ(all[0].points.colours[1], (Rgb8{0, 255, 0}));
    EXPECT_EQ(all[0].points.normals[1], (Vec3f{1, 0, 0}));
    EXPECT_EQ(all[0].points.intensities[1], 5.5f);
}

TEST(TextTable, WhatIsWorkedOutCanBeOverridden) {
    const auto scans = scans_from("3 2 1 10 20 30 0.5\n4 3 2 11 21 31 0.75\n",
                                  {.columns = "z y x - - - intensity"});
    EXPECT_EQ(scans[0].points.positions[0], (Vec3f{1, 2, 3}));
    EXPECT_EQ(scans[0].points.intensities[1], 0.75f);
    EXPECT_TRUE(scans[0].points.colours.empty());
    expect_three_points("1.5|-2|10\n2.5|-2|20\n3.5|-2|30\n",
                        {.columns = "x,y,z", .delimiter = '|'});
}

TEST(Pts, WhatItsColumnsMeanCanBeOverridden) {
    const std::string pts = "2\n1 2 3 10 20 30\n4 5 6 11 21 31\n";
    EXPECT_EQ(scans_from(pts)[0].points.colours[0], (Rgb8{10, 20, 30}));
    const Points points = scans_from(pts, {.columns = "y x z - - intensity"})[0].points;
    EXPECT_EQ(points.positions[0], (Vec3f{2, 1, 3}));
    EXPECT_EQ(points.intensities[1], 31.0f);
    EXPECT_TRUE(points.colours.empty());
    EXPECT_EQ(testing::outcome_of(pts, {.columns = "x y"}).code, ExitCode::kUnreadable);
}

TEST(TextTable, LinesThatAreNoPointsAreCounted) {
    ReadReport report;
    std::string content;
    for (int i = 1; i <= 40; ++i)
        content += i == 20 ? "broken\n" : std::to_string(i) + " 1 1\n";
    EXPECT_EQ(scans_from(content, {}, &report)[0].points.size(), 39u);
    EXPECT_EQ(report.scans[0].invalid, 1u);
}

TEST(TextTable, NotesPosesAndOtherTextAreNoScans) {
    for (const char* content :
         {"Dear reader,\nthe scans are 3 and 4.\n", "12\n15\n17\n", "1 2\n3 4\n",
          "X,Y,X\n\n0, 0, 0\n1, 1, 1\n", "1 0 0 5\n0 1 0 6\n0 0 1 7\n0 0 0 1\n",
          "scan1 1 0 0 5 0 1 0 6 0 0 1 7 0 0 0 1\n", "px,py,pz,nx,ny,nz\n1,2,3,0,0,1\n",
          "{\"scans\": [\n[1, 2, 3],\n[4, 5, 6]\n]}\n", " \n\n", "1 2 3\0x"}) {
        EXPECT_EQ(outcome_of(content).code,
                  content == std::string("1 2 3") ? ExitCode::kDone : ExitCode::kUnreadable)
            << content;
    }
    EXPECT_EQ(outcome_of(std::string("1 2 3\n4 5 6\n\0", 13)).code, ExitCode::kUnreadable);
}

TEST(TextTable, ALineOfMegabytesIsRefused) {
    const std::string content =
        "1 2 3\n2 3 4\n" + std::string(100, '\n') + std::string(3 << 20, '7') + "\n";
    const auto outcome = outcome_of(content);
    EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
    EXPECT_NE(outcome.sentence.find("megabyte"), std::string::npos) << outcome.sentence;
}

TEST(TextTable, NumbersDoNotDependOnTheLocale) {
    const char* chosen = std::setlocale(LC_NUMERIC, "de_DE.UTF-8");
    expect_three_points("1.5 -2 10\n2.5 -2 20\n3.5 -2 30\n");
    std::setlocale(LC_NUMERIC, "C");
    std::printf("tried with the locale %s\n",
                chosen != nullptr ? chosen : "C (de_DE is not installed)");
}

TEST(Pts, CountsThatLieDoNotLosePointsAndCloudsMayFollowOneAnother) {
    ReadReport report;
    const auto scans = scans_from(
        "2\n1 2 3 -5 1 2 3\n2 2 3 -6 4 5 6\n3 2 3 -7 7 8 9\n5\n4 2 3 -8 1 1 1\n", {}, &report);
    ASSERT_EQ(scans.size(), 2u);
    EXPECT_EQ(scans[0].points.size(), 3u);
    EXPECT_EQ(scans[0].points.colours[2], (Rgb8{7, 8, 9}));
    EXPECT_EQ(scans[1].points.intensities, (std::vector<float>{-8}));
    EXPECT_EQ(report.scans[0].declared, 2u);
    EXPECT_EQ(report.scans[1].declared, 5u);
    EXPECT_EQ(scans[1].name, "scan#2");
}

const std::string kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";

std::string ptx(const std::string& position, const std::string& matrix) {
    return "2\n2\n" + position + "1 0 0\n0 1 0\n0 0 1\n" + matrix +
           "1 0 0 0.5 255 0 0\n0 0 0 0.5 0 0 0\n0 2 0 0.25 0 255 0\n0 0 3 1 0 0 255\n";
}

TEST(Ptx, ScansCarryTheirPosesAndNoReturnsAreDropped) {
    const std::string turned =
        "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n";  // a quarter turn about z
    ReadReport report;
    const auto scans =
        scans_from(ptx("0 0 0\n", kIdentity) + ptx("10 20 30\n", turned), {}, &report);
    ASSERT_EQ(scans.size(), 2u);
    ASSERT_TRUE(scans[0].T_world_scan && scans[1].T_world_scan)
        << "registered together, so identity is a pose";
    EXPECT_TRUE(scans[1].has_viewpoint);
    EXPECT_EQ(report.scans[1].invalid, 1u);
    EXPECT_EQ(scans[1].points.size(), 3u);
    EXPECT_EQ(scans[1].points.colours[1], (Rgb8{0, 255, 0}));
    EXPECT_EQ(scans[1].points.grid, (std::vector<GridCell>{{0, 0}, {0, 1}, {1, 1}}));
    const Eigen::Vector3d world = *scans[1].T_world_scan * Eigen::Vector3d(1, 0, 0);
    EXPECT_LT((world - Eigen::Vector3d(10, 21, 30)).norm(), 1e-12);
}

TEST(Ptx, AnUnregisteredScanHasNoPoseAndANonRigidMatrixIsApplied) {
    EXPECT_FALSE(scans_from(ptx("0 0 0\n", kIdentity))[0].T_world_scan);
    ReadReport report;
    const auto scaled =
        scans_from(ptx("0 0 0\n", "1 0 0 0\n0 1 0 0\n0 0 2 0\n5 0 0 1\n"), {}, &report);
    EXPECT_FALSE(scaled[0].T_world_scan);
    EXPECT_EQ(scaled[0].points.positions[2], (Vec3f{5, 0, 6}));
    EXPECT_EQ(report.notes.size(), 1u);
}

TEST(Ptx, ATruncatedScanKeepsItsPointsAndABrokenHeaderIsRefused) {
    std::string content = ptx("0 0 0\n", kIdentity);
    ReadReport report;
    const auto scans = scans_from(content.substr(0, content.size() - 30), {}, &report);
    EXPECT_LT(scans[0].points.size(), 3u);
    EXPECT_EQ(report.scans[0].declared, 4u);
    EXPECT_EQ(outcome_of(content + "2\n2\n0 0 0\n1 0 0\n").code, ExitCode::kUnreadable);
    EXPECT_EQ(outcome_of(content + "2\n2\nzero\n").code, ExitCode::kUnreadable);
}

}  // namespace
}  // namespace glowworm
