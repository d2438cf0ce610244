#include "preprocess/read/e57.h"

#include <cmath>
#include <limits>
#include <random>

#include "e57_bytes.h"
#include "hostile.h"
#include "preprocess/read/e57_pages.h"

namespace glowworm::testing {
namespace {

constexpr const char* kXyzDoubles =
    "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";

std::string doubles(const std::vector<double>& values) {
    std::string bytes;
    for (const double value : values)
        append(bytes, value);
    return bytes;
}

std::string floats(const std::vector<float>& values) {
    std::string bytes;
    for (const float value : values)
        append(bytes, value);
    return bytes;
}

std::string packed(const std::vector<std::uint64_t>& values, int bits) {
    BitString string;
    for (const std::uint64_t value : values)
        string.add(value, bits);
    return string.bytes();
}

std::vector<std::byte> as_bytes(std::string_view text) {
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    return {begin, begin + text.size()};
}

TEST(Crc32c, HasItsPublishedValuesByEitherWay) {
    EXPECT_EQ(crc32c(as_bytes("123456789")), 0xe3069283u);
    EXPECT_EQ(crc32c(std::vector<std::byte>(32)), 0x8a9136aau);  // RFC 3720, B.4
    EXPECT_EQ(crc32c({}), 0u);
    std::mt19937 random(1);
    std::vector<std::byte> bytes(300);
    for (std::byte& byte : bytes)
        byte = static_cast<std::byte>(random());
    for (std::size_t size = 0; size <= bytes.size(); ++size) {
        const std::span<const std::byte> part(bytes.data(), size);
        ASSERT_EQ(crc32c(part), crc32c_by_tables(part)) << size;
    }
}

TEST(E57Pages, OffsetsSkipTheChecksums) {
    EXPECT_EQ(e57_logical(0), 0u);
    EXPECT_EQ(e57_logical(1019), 1019u);
    EXPECT_EQ(e57_logical(1024), 1020u);
    EXPECT_EQ(e57_logical(1022), 1020u) << "inside a checksum";
    for (const std::uint64_t logical : {0ull, 5ull, 1019ull, 1020ull, 5000ull, 123456789ull}) {
        EXPECT_EQ(e57_logical(e57_physical(logical)), logical);
    }
}

TEST(E57, DoublesFloatsAndIntegersOfAnyWidthGiveTheirValues) {
    for (int bits = 1; bits <= 64; ++bits) {
        SCOPED_TRACE(bits);
        // x: double, y: float, z: integer from -5 on, in packets that cut its bits anywhere.
        const std::uint64_t range = bits == 64 ? ~0ull : (1ull << bits) - 1;
        const std::int64_t least = bits == 64 ? std::numeric_limits<std::int64_t>::min() : -5;
        const auto most = static_cast<std::int64_t>(static_cast<std::uint64_t>(least) + range);
        std::mt19937_64 random(static_cast<unsigned>(bits));
        std::vector<double> x;
        std::vector<float> y;
        std::vector<std::uint64_t> z;
        for (int i = 0; i < 100; ++i) {
            x.push_back(0.001 * i);
            y.push_back(0.25f * static_cast<float>(i));
            z.push_back(i == 0 ? range : random() & range);
        }
        const std::string all_x = doubles(x), all_y = floats(y), all_z = packed(z, bits);
        std::vector<std::string> packets;
        const auto part = [](const std::string& bytes, std::size_t i) {
            return bytes.substr(bytes.size() * i / 7,
                                bytes.size() * (i + 1) / 7 - bytes.size() * i / 7);
        };
        for (std::size_t i = 0; i < 7; ++i) {
            packets.push_back(e57_packet({part(all_x, i), part(all_y, i), part(all_z, i)}));
        }
        const std::string fields =
            "<cartesianX type=\"Float\"/><cartesianY type=\"Float\" precision=\"single\"/>"
            "<cartesianZ type=\"ScaledInteger\" minimum=\"" +
            std::to_string(least) + "\" maximum=\"" + std::to_string(most) +
            "\" scale=\"1e-3\" offset=\"2\"/>";
        const ScratchFolder folder;
        const auto file = open_scan_file(write_file(folder / "a", e57_of(fields, 100, packets)));
        ScanHeader header;
        ASSERT_TRUE(file->next_scan(header));
        EXPECT_EQ(header.declared_points, 100u);
        PointBlock block;
        ASSERT_TRUE(file->next_block(block));
        ASSERT_EQ(block.size(), 100u);
        for (std::size_t i = 0; i < 100; ++i) {
            EXPECT_EQ(block.positions[i].x, x[i]);
            EXPECT_EQ(block.positions[i].y, static_cast<double>(y[i]));
            const double stored = static_cast<double>(
                static_cast<std::int64_t>(static_cast<std::uint64_t>(least) + z[i]));
            EXPECT_EQ(block.positions[i].z, stored * 1e-3 + 2.0);
        }
        EXPECT_FALSE(file->next_block(block));
        EXPECT_FALSE(file->next_scan(header));
    }
}

TEST(E57, FieldsOfNoBitsHaveTheirMinimum) {
    const std::string fields =
        "<cartesianX type=\"Float\"/><cartesianY type=\"Float\"/>"
        "<cartesianZ type=\"ScaledInteger\" minimum=\"7\" maximum=\"7\" scale=\"0.5\"/>";
    const auto scans =
        scans_from(e57_of(fields, 2, {e57_packet({doubles({1, 2}), doubles({3, 4}), ""})}));
    EXPECT_EQ(scans[0].points.positions[1], (Vec3f{2.0f, 4.0f, 3.5f}));
}

TEST(E57, PointsOfNoBytesAtAllAreNotBelieved) {
    std::string fields;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"}) {
        fields += std::string("<") + name + " type=\"Integer\" minimum=\"1\" maximum=\"1\"/>";
    }
    EXPECT_EQ(scans_from(e57_of(fields, 3, {}))[0].points.size(), 3u);
    EXPECT_EQ(outcome_of(e57_of(fields, 1ull << 60, {})).code, ExitCode::kUnreadable);
}

TEST(E57, SphericalCoordinatesAreTurnedIntoCartesianOnes) {
    const std::string fields =
        "<sphericalRange type=\"Float\"/><sphericalAzimuth type=\"Float\"/>"
        "<sphericalElevation type=\"Float\"/>"
        "<sphericalInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>";
    const double quarter = std::acos(0.0);
    ReadReport report;
    const auto scans = scans_from(
        e57_of(fields, 5,
               {e57_packet({doubles({2, 2, 2, 9, 9}), doubles({0, quarter, 0, 0, 0}),
                            doubles({0, 0, quarter, 0, 0}), packed({0, 0, 0, 1, 2}, 2)})}),
        {}, &report);
    ASSERT_EQ(scans[0].points.size(), 3u);
    EXPECT_EQ(report.scans[0].invalid, 2u);
    const Vec3f truth[] = {{2, 0, 0}, {0, 2, 0}, {0, 0, 2}};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT(length(scans[0].points.positions[i] - truth[i]), 1e-6f) << i;
    }
}

TEST(E57, ColoursAndIntensitiesAreScaledByTheirLimitsMinimumIncluded) {
    const std::string fields = std::string(kXyzDoubles) +
                               "<colorRed type=\"Integer\" minimum=\"0\" maximum=\"65535\"/>"
                               "<colorGreen type=\"Integer\" minimum=\"0\" maximum=\"65535\"/>"
                               "<colorBlue type=\"Float\" precision=\"single\"/>"
                               "<intensity type=\"Integer\" minimum=\"-2048\" maximum=\"2047\"/>";
    const std::vector<std::string> streams = {doubles({1, 2, 3}),
                                              doubles({1, 1, 1}),
                                              doubles({0, 0, 0}),
                                              packed({0, 32768, 65535}, 16),
                                              packed({1000, 1500, 2000}, 16),
                                              floats({0.0f, 0.5f, 1.0f}),
                                              packed({0, 1024, 4095}, 12)};
    const std::string limits =
        "<colorLimits type=\"Structure\"><colorGreenMinimum type=\"Integer\">1000"
        "</colorGreenMinimum><colorGreenMaximum type=\"Integer\">2000</colorGreenMaximum>"
        "</colorLimits><intensityLimits type=\"Structure\"><intensityMinimum type=\"Integer\">-1024"
        "</intensityMinimum><intensityMaximum type=\"Integer\">1024</intensityMaximum>"
        "</intensityLimits>";
    const Points points = scans_from(e57_of(fields, 3, {e57_packet(streams)}, limits))[0].points;
    EXPECT_EQ(points.colours[0], (Rgb8{0, 0, 0}));
    EXPECT_EQ(points.colours[1], (Rgb8{128, 128, 128}));
    EXPECT_EQ(points.colours[2], (Rgb8{255, 255, 255}));
    EXPECT_FLOAT_EQ(points.intensities[0], -0.5f);
    EXPECT_FLOAT_EQ(points.intensities[1], 0.0f);

    const Points declared = scans_from(e57_of(fields, 3, {e57_packet(streams)}))[0].points;
    EXPECT_FLOAT_EQ(declared.intensities[0], 0.0f);
    EXPECT_FLOAT_EQ(declared.intensities[2], 1.0f);
    EXPECT_EQ(declared.colours[2].g, 8);
}

TEST(E57, NormalsAndTimesAreRead) {
    const std::string fields =
        std::string(kXyzDoubles) +
        "<nor:normalX type=\"Float\"/><nor:normalY type=\"Float\"/><nor:normalZ type=\"Float\"/>"
        "<timeStamp type=\"Float\"/><rowIndex type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
        "<columnIndex type=\"Integer\" minimum=\"0\" maximum=\"255\"/>";
    const ScratchFolder folder;
    const auto file = open_scan_file(write_file(
        folder / "a",
        e57_of(fields, 1,
               {e57_packet({doubles({1}), doubles({2}), doubles({3}), doubles({0}), doubles({-1}),
                            doubles({0}), doubles({1234.5}), "\3", "\4"})})));
    ScanHeader header;
    PointBlock block;
    ASSERT_TRUE(file->next_scan(header) && file->next_block(block));
    EXPECT_EQ(block.normals[0], (Vec3f{0, -1, 0}));
    EXPECT_EQ(block.times[0], 1234.5);
    EXPECT_TRUE(header.has_viewpoint) << "a grid of rows and columns is seen from the origin";
    EXPECT_EQ(header.fields.size(), 9u);
    EXPECT_EQ(header.fields[3].meaning, "nx");
    EXPECT_EQ(header.fields[7].meaning, "row");
    EXPECT_TRUE(header.columns.grid);
    EXPECT_EQ(block.grid, (std::vector<GridCell>{{3, 4}}));
}

TEST(E57, PointsMarkedAsWithoutColourOrIntensityGetThoseOfTheOthersAndAreCounted) {
    const std::string fields =
        std::string(kXyzDoubles) +
        "<colorRed type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
        "<colorGreen type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
        "<colorBlue type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
        "<isColorInvalid type=\"Integer\" minimum=\"0\" maximum=\"1\"/>"
        "<intensity type=\"Float\" precision=\"single\"/>"
        "<isIntensityInvalid type=\"Integer\" minimum=\"0\" maximum=\"1\"/>"
        "<cartesianInvalidState type=\"Integer\" minimum=\"0\" maximum=\"2\"/>";
    // Of the first and the last point there is nothing to see; the last is no point at all.
    const auto file_of = [&](const std::vector<std::uint64_t>& no_colour) {
        return e57_of(fields, 4,
                      {e57_packet({doubles({1, 2, 3, 4}), doubles({1, 1, 1, 1}),
                                   doubles({0, 0, 0, 0}), packed({0, 100, 200, 0}, 8),
                                   packed({0, 50, 60, 0}, 8), packed({0, 10, 10, 0}, 8),
                                   packed(no_colour, 1), floats({0.0f, 0.25f, 0.75f, 9.0f}),
                                   packed({1, 0, 0, 0}, 1), packed({0, 0, 0, 2}, 2)})});
    };
    ReadReport report;
    const Points points = scans_from(file_of({1, 0, 0, 1}), {}, &report)[0].points;
    EXPECT_EQ(points.colours, (std::vector<Rgb8>{{150, 55, 10}, {100, 50, 10}, {200, 60, 10}}));
    EXPECT_EQ(points.intensities, (std::vector<float>{0.5f, 0.25f, 0.75f}));
    EXPECT_EQ(report.scans[0].invalid, 1u);
    EXPECT_EQ(report.scans[0].no_colour, 1u);
    EXPECT_EQ(report.scans[0].no_intensity, 1u);

    const Points grey = scans_from(file_of({1, 1, 1, 1}), {}, &report)[0].points;
    EXPECT_EQ(grey.colours, (std::vector<Rgb8>(3, {188, 188, 188}))) << "and not black";
    EXPECT_EQ(report.scans[0].no_colour, 3u);
}

TEST(E57, LimitsInScaledIntegersAndFieldsOfUnknownExtensionsAreUnderstood) {
    const std::string fields =
        "<x:intensity type=\"Float\"/>" + std::string(kXyzDoubles) +
        "<x:normalX type=\"String\"/>"
        "<intensity type=\"ScaledInteger\" minimum=\"0\" maximum=\"255\" scale=\"0.5\"/>"
        "<colorRed type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
        "<colorGreen type=\"Integer\" minimum=\"0\" maximum=\"255\"/>"
        "<colorBlue type=\"Integer\" minimum=\"0\" maximum=\"255\"/>";
    const std::string limits =
        "<intensityLimits type=\"Structure\"><intensityMinimum type=\"ScaledInteger\" "
        "minimum=\"0\" maximum=\"255\" scale=\"0.5\">20</intensityMinimum><intensityMaximum "
        "type=\"ScaledInteger\" minimum=\"0\" maximum=\"255\" scale=\"0.5\">220</intensityMaximum>"
        "</intensityLimits><colorLimits type=\"Structure\"><colorRedMinimum "
        "type=\"Integer\">0</colorRedMinimum><colorRedMaximum "
        "type=\"Integer\">65535</colorRedMaximum></colorLimits>";
    const std::vector<std::string> streams = {doubles({7}), doubles({1}), doubles({2}),
                                              doubles({3}), "\3abc",      "\x78",
                                              "\x64",       "\x65",       "\x66"};
    const Points points = scans_from(e57_of(fields, 1, {e57_packet(streams)}, limits))[0].points;
    EXPECT_FLOAT_EQ(points.intensities[0], 0.5f);
    EXPECT_EQ(points.colours[0], (Rgb8{100, 101, 102})) << "8 bits cannot reach a limit of 65535";
}

TEST(E57, PacketsWithoutPointsIndexPacketsAndPacketsToPassOverAreNoPoints) {
    const std::string points = e57_packet({doubles({1}), doubles({2}), doubles({3})});
    const std::string empty = e57_packet({"", "", ""});
    std::string index("\0\0\x0f\0", 4), ignored("\2\0\x07\0", 4);
    index += std::string(12, '\0');
    ignored += std::string(4, '\xff');
    const Points read =
        scans_from(e57_of(kXyzDoubles, 2, {empty, index, points, ignored, empty, points, index}))[0]
            .points;
    EXPECT_EQ(read.positions, (std::vector<Vec3f>{{1, 2, 3}, {1, 2, 3}}));
}

std::string pose_xml(double w, double x, double y, double z) {
    return "<pose type=\"Structure\"><rotation type=\"Structure\"><w type=\"Float\">" +
           std::to_string(w) + "</w><x type=\"Float\">" + std::to_string(x) +
           "</x><y type=\"Float\">" + std::to_string(y) + "</y><z type=\"Float\">" +
           std::to_string(z) +
           "</z></rotation><translation type=\"Structure\">"
           "<x type=\"Float\">10</x><y type=\"Float\"/><z "
           "type=\"Float\">-2.5</z></translation></pose>";
}

TEST(E57, EveryScanHasItsPoseAndName) {
    const std::string packet = e57_packet({doubles({1, 2}), doubles({3, 4}), doubles({5, 6})});
    const std::string first = e57_section(48, packet);
    const std::string second = e57_section(48 + first.size(), packet);
    const std::string name = "<name type=\"String\"><![CDATA[грот \xe6\xb4\x9e]]></name>";
    const std::string file =
        e57_file(first + second,
                 e57_xml(e57_scan_xml(kXyzDoubles, 2, name + pose_xml(0.5, 0.5, 0.5, 0.5)) +
                         e57_scan_xml(kXyzDoubles, 0, pose_xml(0, 0, 0, 0), 0) +
                         e57_scan_xml(kXyzDoubles, 2, pose_xml(0, 0, 0, 0), 48 + first.size())));
    const ScratchFolder folder;
    const auto open = open_scan_file(write_file(folder / "a", file));
    ScanHeader header;
    ASSERT_TRUE(open->next_scan(header));
    EXPECT_EQ(header.name, "грот \xe6\xb4\x9e");
    ASSERT_TRUE(header.T_world_scan.has_value());
    // The quaternion takes x to y, y to z and z to x.
    const Eigen::Vector3d moved = *header.T_world_scan * Eigen::Vector3d(1, 3, 5);
    EXPECT_LT((moved - Eigen::Vector3d(15, 1, 0.5)).norm(), 1e-12);
    PointBlock block;
    ASSERT_TRUE(open->next_scan(header)) << "the points of the first are passed over";
    EXPECT_FALSE(open->next_block(block)) << "the second has none";
    ASSERT_TRUE(open->next_scan(header));
    EXPECT_FALSE(header.T_world_scan.has_value());
    EXPECT_EQ(header.notes.size(), 1u) << "a zero quaternion is no pose";
    ASSERT_TRUE(open->next_block(block));
    EXPECT_EQ(block.positions[1], (Vec3d{2, 4, 6}));
    EXPECT_FALSE(open->next_scan(header));
}

std::string whole_file() {
    return e57_of(
        kXyzDoubles, 50,
        {e57_packet({doubles(std::vector<double>(25, 1)), doubles(std::vector<double>(25, 2)),
                     doubles(std::vector<double>(25, 3))}),
         e57_packet({doubles(std::vector<double>(25, 4)), doubles(std::vector<double>(25, 5)),
                     doubles(std::vector<double>(25, 6))})});
}

TEST(E57, AWrongChecksumIsRefusedAndReadWithoutChecking) {
    std::string file = whole_file();
    file[300] = static_cast<char>(file[300] ^ 4);
    const Outcome outcome = outcome_of(file);
    EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
    EXPECT_THAT(outcome.sentence, ::testing::HasSubstr("--no-crc"));
    ReadSettings salvage;
    salvage.check_crc = false;
    EXPECT_EQ(scans_from(file, salvage)[0].points.size(), 50u);
}

TEST(E57, PacketsThatLieAreRefused) {
    const auto outcome = [](const std::vector<std::string>& packets, std::uint64_t count = 2) {
        return outcome_of(e57_of(kXyzDoubles, count, packets)).code;
    };
    const std::string two = doubles({1, 2});
    const std::string good = e57_packet({two, two, two});
    const std::string ignored("\2\0\7\0\0\0\0\0", 8), index("\0\0\7\0\0\0\0\0", 8);
    EXPECT_EQ(outcome({good}), ExitCode::kDone);
    EXPECT_EQ(outcome({index, ignored, good}), ExitCode::kDone);
    EXPECT_EQ(outcome({good}, 3), ExitCode::kUnreadable) << "more announced than there";
    EXPECT_EQ(outcome({good}, 1ull << 62), ExitCode::kUnreadable);
    EXPECT_EQ(outcome({e57_packet({two, two})}), ExitCode::kUnreadable) << "a field missing";
    EXPECT_EQ(outcome({e57_packet({two, two, ""})}), ExitCode::kUnreadable);
    std::string longer = good;
    longer[6] = 60;  // bytes of the first stream
    EXPECT_EQ(outcome({longer}), ExitCode::kUnreadable);
    std::string endless = good;
    endless[2] = endless[3] = '\xff';
    EXPECT_EQ(outcome({endless}), ExitCode::kUnreadable);
    std::string unknown = good;
    unknown[0] = 3;
    EXPECT_EQ(outcome({unknown}), ExitCode::kUnreadable);
    std::string zero(8, '\0');  // an index packet of one byte
    EXPECT_EQ(outcome({zero, good}), ExitCode::kUnreadable);
}

TEST(E57, SectionsThatPointAwayAreRefused) {
    const std::string packet = e57_packet({doubles({1}), doubles({2}), doubles({3})});
    for (const std::uint64_t at : {0ull, 8ull, 47ull, 1ull << 40, ~0ull}) {
        const std::string xml =
            e57_xml(e57_scan_xml(kXyzDoubles, 1))
                .replace(e57_xml(e57_scan_xml(kXyzDoubles, 1)).find("fileOffset=\"48\"") + 12, 2,
                         std::to_string(at));
        EXPECT_EQ(outcome_of(e57_file(e57_section(48, packet), xml)).code, ExitCode::kUnreadable)
            << at;
    }
    for (const std::size_t number : {8u, 16u}) {  // length and data offset
        for (const std::uint64_t value : {0ull, 1ull, 1ull << 40, ~0ull}) {
            std::string section = e57_section(48, packet);
            std::memcpy(section.data() + number, &value, 8);
            EXPECT_EQ(outcome_of(e57_file(section, e57_xml(e57_scan_xml(kXyzDoubles, 1)))).code,
                      ExitCode::kUnreadable)
                << number << " " << value;
        }
    }
}

TEST(E57, HostileXmlIsRefused) {
    const auto outcome = [](const std::string& xml) { return outcome_of(e57_file("", xml)); };
    const std::string bomb =
        "<?xml version=\"1.0\"?><!DOCTYPE a [<!ENTITY b \"bbbbbbbb\"><!ENTITY c \"&b;&b;&b;\">]>"
        "<e57Root>&c;</e57Root>";
    EXPECT_THAT(outcome(bomb).sentence, ::testing::HasSubstr("document type"));
    EXPECT_EQ(outcome("<!DOCTYPE a SYSTEM \"file:///etc/passwd\"><e57Root/>").code,
              ExitCode::kUnreadable);
    std::string deep;
    for (int i = 0; i < 100000; ++i)
        deep += "<a>";
    EXPECT_THAT(outcome(deep).sentence, ::testing::HasSubstr("nested"));
    std::string wide = "<e57Root>";
    for (int i = 0; i < 1100000; ++i)
        wide += "<a/>";
    EXPECT_THAT(outcome(wide + "</e57Root>").sentence, ::testing::HasSubstr("elements"));
    EXPECT_THAT(outcome("<e57Root><a></e57Root>").sentence, ::testing::HasSubstr("line 1"));
    EXPECT_EQ(outcome("").code, ExitCode::kUnreadable);
    EXPECT_EQ(outcome("<e57Root/>").code, ExitCode::kDegenerate);
    for (const char* field : {"<cartesianX type=\"Integer\" minimum=\"5\" maximum=\"4\"/>",
                              "<cartesianX type=\"Integer\" minimum=\"x\"/>",
                              "<cartesianX type=\"ScaledInteger\" scale=\"nan\"/>",
                              "<cartesianX type=\"Blob\"/>", "<cartesianX type=\"String\"/>", ""}) {
        const std::string fields =
            std::string(field) + "<cartesianY type=\"Float\"/><cartesianZ type=\"Float\"/>";
        EXPECT_EQ(
            outcome_of(e57_of(fields, 1, {e57_packet({doubles({1}), doubles({1}), doubles({1})})}))
                .code,
            ExitCode::kUnreadable)
            << field;
    }
}

TEST(E57, DamageIsRefusedOrReadButNeverMore) {
    const std::string file = whole_file();
    EXPECT_EQ(refused_when_cut(file), file.size());
    EXPECT_EQ(refused_when_flipped(file, 0, 200), 1600u) << "the checksums see every bit";
    ReadSettings salvage;
    salvage.check_crc = false;
    refused_when_flipped(file, 0, 140, salvage);
    refused_when_flipped(file, 1024, 1400, salvage);
    EXPECT_GT(refused_when_overwritten(file, 5, salvage), 10u);
}

struct Reference {
    const char* file;
    std::vector<std::uint64_t> points;  ///< per scan, as in the XML section
    std::uint64_t invalid = 0;
    bool coloured = false;
};

TEST(E57, EveryReferenceFileHoldsWhatItDeclares) {
    GLOWWORM_DATA_OR_SKIP(data);
    const Reference references[] = {
        {"e57/cry-inc-e57/tinyCartesianFloatRgb.e57", {2090}, 0, true},
        {"e57/cry-inc-e57/integer_intensity.e57", {2}},
        {"e57/cry-inc-e57/tiny_pc_and_images.e57", {2}},
        {"e57/cry-inc-e57/tiny_spherical.e57", {360}, 180},
        {"e57/libE57Format-test-data/3rdParty/las2e57/ColourRepresentation.e57", {153}, 0, true},
        {"e57/libE57Format-test-data/reference/bunnyDouble.e57", {30571}},
        {"e57/libE57Format-test-data/reference/bunnyInt32.e57", {30571}},
        {"e57/libE57Format-test-data/self/ColouredCubeDouble.e57", {7680}, 0, true},
        {"e57/libE57Format-test-data/self/ColouredCubeFloat.e57", {7680}, 0, true},
        {"e57/libE57Format-test-data/self/ZeroPoints.e57", {0}},
        {"e57/libE57Format-test-data/self/ZeroPointsInvalid.e57", {0}},
        {"e57/libE57Format-test-data/self/InvalidCVHeader.e57", {0}},
        {"e57/libE57Format-test-data/self/empty.e57", {}},
        {"e57/libE57Format-test-data/self/PinholeImageWithDistortionParameters.e57", {}},
        {"e57/libE57Format-test-data/self/测试点云.e57", {}},
        {"e57/libE57Format-test-data/self/test filename äöü.e57", {}},
        {"pdal/e57/A_B.e57", {2, 4}, 0, true},
        {"pdal/e57/A_moved_B.e57", {2, 4}, 0, true},
    };
    for (const Reference& reference : references) {
        SCOPED_TRACE(reference.file);
        const auto file = open_scan_file(data / "formats" / reference.file);
        ScanHeader header;
        PointBlock block;
        std::vector<std::uint64_t> points;
        std::uint64_t invalid = 0;
        Vec3d least{HUGE_VAL, HUGE_VAL, HUGE_VAL}, most = -least;
        unsigned brightest = 0;
        while (file->next_scan(header)) {
            points.push_back(0);
            EXPECT_EQ(header.columns.colours, reference.coloured);
            while (file->next_block(block)) {
                points.back() += block.size() + block.invalid;
                invalid += block.invalid;
                for (const Vec3d& p : block.positions) {
                    least = component_min(least, p);
                    most = component_max(most, p);
                }
                for (const Rgb8& c : block.colours) {
                    brightest = std::max<unsigned>({brightest, c.r, c.g, c.b});
                }
            }
        }
        EXPECT_EQ(points, reference.points);
        EXPECT_EQ(invalid, reference.invalid);
        EXPECT_EQ(brightest > 100, reference.coloured);
        std::printf("%-72s %zu scans, %llu points, x %g..%g y %g..%g z %g..%g\n", reference.file,
                    points.size(),
                    points.empty() ? 0ull : static_cast<unsigned long long>(points[0]), least.x,
                    most.x, least.y, most.y, least.z, most.z);
    }
}

TEST(E57, ReferenceBoundsAreThoseOfTheXmlSection) {
    GLOWWORM_DATA_OR_SKIP(data);
    struct Bounds {
        const char* file;
        Vec3d least, most;
    };
    const Bounds truths[] = {
        {"reference/bunnyDouble.e57",
         {-0.094689, 0.040011, -0.061873},
         {0.061009, 0.187321, 0.058799}},
        {"reference/bunnyInt32.e57",
         {-0.094689, 0.040011, -0.061873},
         {0.061009, 0.187321, 0.058799}},
        {"self/ColouredCubeFloat.e57", {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}},
        {"self/ColouredCubeDouble.e57", {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}},
        {"3rdParty/las2e57/ColourRepresentation.e57", {-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}},
    };
    for (const Bounds& truth : truths) {
        const auto file = open_scan_file(data / "formats/e57/libE57Format-test-data" / truth.file);
        ScanHeader header;
        PointBlock block;
        Vec3d least{HUGE_VAL, HUGE_VAL, HUGE_VAL}, most = -least;
        file->next_scan(header);
        while (file->next_block(block)) {
            for (const Vec3d& p : block.positions) {
                least = component_min(least, p);
                most = component_max(most, p);
            }
        }
        EXPECT_LT(length(least - truth.least), 1e-9) << truth.file;
        EXPECT_LT(length(most - truth.most), 1e-9) << truth.file;
    }
}

TEST(E57, ReferenceFilesWithWrongChecksumsAreRefused) {
    GLOWWORM_DATA_OR_SKIP(data);
    for (const char* name :
         {"e57/cry-inc-e57/corrupt_crc.e57", "e57/libE57Format-test-data/self/bad-crc.e57"}) {
        const Outcome outcome = outcome_of_reading(data / "formats" / name);
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
        EXPECT_THAT(outcome.sentence, ::testing::HasSubstr("checksum"));
    }
    ReadSettings salvage;
    salvage.check_crc = false;
    EXPECT_EQ(
        read_scans(data / "formats/e57/cry-inc-e57/corrupt_crc.e57", salvage)[0].points.size(),
        2090u);
}

}  // namespace
}  // namespace glowworm::testing
