#include "preprocess/read/preflight.h"

#include <random>

#include "preprocess/read/describe.h"
#include "scan_text.h"

namespace glowworm {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A wall of 20 000 points, 5 x 3 m.
Scan wall(const std::string& name, double scale = 1.0) {
    std::mt19937 random(11);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    Scan scan;
    scan.name = name;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f p{5 * unit(random), 0.1f * unit(random), 3 * unit(random)};
        scan.points.positions.push_back(p * static_cast<float>(scale));
        scan.points.colours.push_back({static_cast<std::uint8_t>(i), 7, 9});
    }
    return scan;
}

std::vector<std::string> ids_of(std::span<const Scan> scans,
                                std::span<const ReadReport> reports = {}) {
    std::vector<std::string> ids;
    for (const Warning& warning : preflight(scans, reports)) {
        std::printf("%s: %s [%s]\n", warning.file.c_str(), warning.sentence.c_str(),
                    warning.id.c_str());
        ids.push_back(warning.id);
    }
    return ids;
}

std::vector<std::string> ids_of(const Scan& scan) {
    return ids_of(std::span(&scan, 1));
}

TEST(Preflight, AnOrdinaryScanGivesNoWarningAndNoScansGiveNone) {
    EXPECT_THAT(ids_of(wall("wall")), IsEmpty());
    EXPECT_THAT(preflight(std::span<const Scan>{}), IsEmpty());
}

TEST(Preflight, ColoursThatSayNothingAreNamed) {
    Scan scan = wall("wall");
    scan.points.colours.assign(scan.points.size(), {0, 0, 0});
    EXPECT_THAT(ids_of(scan), Contains("colour-black"));
    scan.points.colours.assign(scan.points.size(), {200, 200, 200});
    EXPECT_THAT(ids_of(scan), Contains("colour-constant"));
}

TEST(Preflight, PointsThatWereDroppedOrRepeatAreNamed) {
    const std::vector<Scan> scans = {wall("wall")};
    ReadReport report;
    report.scans = {
        {.name = "wall", .declared = 30000, .kept = 20000, .not_finite = 3, .no_return = 5000}};
    const auto ids = ids_of(scans, std::span(&report, 1));
    EXPECT_THAT(ids, ::testing::UnorderedElementsAre("points-at-origin", "points-not-finite",
                                                     "points-missing"));
    report.scans = {{.name = "wall",
                     .declared = 20007,
                     .kept = 20000,
                     .too_far = 7,
                     .no_colour = 9,
                     .no_intensity = 11}};
    EXPECT_THAT(
        ids_of(scans, std::span(&report, 1)),
        ::testing::UnorderedElementsAre("points-too-far", "colour-invalid", "intensity-invalid"));
    Scan twice = wall("wall");
    twice.points.append(wall("wall").points);
    EXPECT_THAT(ids_of(twice), Contains("points-duplicate"));
}

TEST(Preflight, UnitsThatCannotBeMetresAreNamed) {
    EXPECT_THAT(ids_of(wall("millimetres", 2000.0)), Contains("units-too-large"));
    EXPECT_THAT(ids_of(wall("kilometres", 0.001)), Contains("units-too-small"));
    ScanFacts degrees;
    degrees.low = {8.54, 47.37, 400};
    degrees.high = {8.5402, 47.3702, 420};
    EXPECT_EQ(preflight(std::span(&degrees, 1)).at(0).id, "units-degrees");
    ScanFacts feet;
    feet.high = {10, 10, 10};
    feet.crs = "PROJCS[\"NAD83 / Oregon\",UNIT[\"Foot\",0.3048]]";
    EXPECT_EQ(preflight(std::span(&feet, 1)).at(0).id, "units-feet");
    // As las_crs says GeoTIFF keys.
    feet.crs = "NAD83 / Oregon, EPSG:2992, unit British foot, vertical unit metre";
    EXPECT_EQ(preflight(std::span(&feet, 1)).at(0).id, "units-feet");
    EXPECT_THAT(preflight(std::span(&feet, 1)).at(0).sentence, Not(HasSubstr("heights")));
    for (const char* crs :
         {"COMPD_CS[\"Oregon (m) + NAVD88 height (ftUS)\",PROJCS[\"Oregon\",UNIT[\"metre\",1]],"
          "VERT_CS[\"NAVD88\",UNIT[\"US survey foot\",0.3048006]]]",
          "UTM 17, unit metre, vertical unit US survey foot"}) {
        feet.crs = crs;
        ASSERT_THAT(preflight(std::span(&feet, 1)), ::testing::SizeIs(1));
        EXPECT_EQ(preflight(std::span(&feet, 1))[0].id, "units-feet");
        EXPECT_THAT(preflight(std::span(&feet, 1))[0].sentence, HasSubstr("heights"));
    }
    feet.crs = "PROJCS[\"Footpath cave, Taft\",UNIT[\"metre\",1]]";
    EXPECT_THAT(preflight(std::span(&feet, 1)), IsEmpty());
    Scan scan = wall("feet");
    scan.crs = "PROJCS[\"NAD83 / Oregon\",UNIT[\"Foot_US\",0.3048006]]";
    EXPECT_THAT(ids_of(scan), Contains("units-feet"));
}

TEST(Preflight, CoordinatesThatFloatBreaksAreNamed) {
    Scan scan = wall("utm");
    scan.offset = {500000, 5400000, 800};
    EXPECT_THAT(ids_of(scan), Not(Contains("float-lost")));
    for (Vec3f& p : scan.points.positions)
        p = {std::round(p.x * 32) / 32, std::round(p.y), std::round(p.z * 32) / 32};
    EXPECT_THAT(ids_of(scan), Contains("float-lost"));
    EXPECT_THAT(ids_of(wall("long", 4000.0)), Contains("float-range"));
}

TEST(Preflight, AScanThatDiffersFromTheOthersIsNamed) {
    std::vector<Scan> scans = {wall("a"), wall("b"), wall("c", 20.0)};
    scans[0].T_world_scan = Eigen::Isometry3d::Identity();
    scans[2].T_world_scan = Eigen::Isometry3d::Identity();
    std::vector<std::string> files;
    for (const Warning& warning : preflight(scans))
        files.push_back(warning.id + " " + warning.file);
    EXPECT_THAT(files, ::testing::UnorderedElementsAre("pose-missing b", "spacing-apart c"));
}

TEST(Spacing, OfAGridIsTheGridsStep) {
    Scan scan;
    for (int x = 0; x < 300; ++x) {
        for (int y = 0; y < 300; ++y) {
            scan.points.positions.push_back(
                {0.02f * static_cast<float>(x), 0.02f * static_cast<float>(y), 1.0f});
        }
    }
    scan.points.append(scan.points);  // stacks of two
    const ScanFacts facts = facts_of(scan, {});
    std::printf("spacing %.6f m of 0.02, duplicate share %.3f of 0.5\n", facts.spacing,
                facts.duplicate_share);
    EXPECT_NEAR(facts.spacing, 0.02, 1e-5);
    EXPECT_NEAR(facts.duplicate_share, 0.5, 1e-9);
}

TEST(Describe, SaysWhatIsInAFile) {
    const testing::ScratchFolder folder;
    const auto path = testing::write_file(folder / "a.ply",
                                          "ply\nformat ascii 1.0\ncomment by hand\nelement vertex "
                                          "5\nproperty double x\nproperty double y\n"
                                          "property double z\nproperty ushort red\nproperty ushort "
                                          "green\nproperty ushort blue\nproperty int other\n"
                                          "end_header\n2000 1 1 65535 0 0 4\n2001 2 1 0 256 0 "
                                          "5\nnan 0 0 1 1 1 1\n0 0 0 0 0 0 0\n0 0 0 0 0 0 0\n");
    const ScanFileDescription file = describe_scan_file(path);
    ASSERT_EQ(file.scans.size(), 1u);
    const ScanDescription& scan = file.scans[0];
    EXPECT_EQ(file.format.name, "PLY");
    EXPECT_EQ(file.points, 2u);
    EXPECT_EQ(scan.facts.counts.not_finite, 1u);
    EXPECT_EQ(scan.facts.counts.no_return, 2u);
    EXPECT_EQ(scan.header.colour_bits, 16);
    EXPECT_NEAR(scan.facts.spacing, std::sqrt(2.0), 1e-9);
    ASSERT_EQ(scan.fields.size(), 7u);
    EXPECT_EQ(scan.fields[3].header.name, "red");
    EXPECT_EQ(scan.fields[3].high, 255.0);
    EXPECT_FALSE(scan.fields[6].has_range);
    EXPECT_EQ(scan.offset, (Vec3d{2001, 2, 1})) << "in the middle, to whole metres";
}

}  // namespace
}  // namespace glowworm
