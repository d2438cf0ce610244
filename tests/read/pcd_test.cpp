#include <cstring>
#include <numbers>
#include <random>

#include "preprocess/read/lzf.h"
#include "scan_text.h"

namespace glowworm {
namespace {

using testing::outcome_of;
using testing::scans_from;

std::string pcd_header(const std::string& points, const std::string& data,
                       const std::string& viewpoint = "0 0 0 1 0 0 0") {
    return "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb normal_x normal_y normal_z intensity\n"
           "SIZE 4 4 4 4 4 4 4 2\nTYPE F F F U F F F U\nCOUNT 1 1 1 1 1 1 1 1\nWIDTH " +
           points + "\nHEIGHT 1\nVIEWPOINT " + viewpoint + "\nPOINTS " + points + "\nDATA " + data +
           "\n";
}

std::string column_bytes(std::size_t column, float value) {
    std::string bytes(column == 7 ? 2 : 4, '\0');
    const auto integer = static_cast<std::uint32_t>(value);
    if (column == 3 || column == 7)
        std::memcpy(bytes.data(), &integer, bytes.size());
    else
        std::memcpy(bytes.data(), &value, 4);
    return bytes;
}

const float kValues[2][8] = {{1, 2, 3, float(0x102030), 0, 0, 1, 500},
                             {4, 5, 6, float(0xff0001), 1, 0, 0, 7}};

void expect_the_two_points(const std::vector<Scan>& scans) {
    ASSERT_EQ(scans.size(), 1u);
    const Points& points = scans[0].points;
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.positions[1], (Vec3f{4, 5, 6}));
    EXPECT_EQ(points.colours[0], (Rgb8{0x10, 0x20, 0x30}));
    EXPECT_EQ(points.colours[1], (Rgb8{0xff, 0, 1}));
    EXPECT_EQ(points.normals[1], (Vec3f{1, 0, 0}));
    EXPECT_EQ(points.intensities[0], 500.0f);
    EXPECT_FALSE(scans[0].T_world_scan.has_value());
}

std::string binary_pcd() {
    std::string content = pcd_header("2", "binary");
    for (const auto& point : kValues) {
        for (std::size_t c = 0; c < 8; ++c)
            content += column_bytes(c, point[c]);
    }
    return content;
}

std::string compressed_pcd() {
    std::string columns;
    for (std::size_t c = 0; c < 8; ++c) {
        for (const auto& point : kValues)
            columns += column_bytes(c, point[c]);
    }
    const auto packed = encode_lzf(std::as_bytes(std::span(columns)));
    const std::uint32_t sizes[2] = {static_cast<std::uint32_t>(packed.size()),
                                    static_cast<std::uint32_t>(columns.size())};
    return pcd_header("2", "binary_compressed") +
           std::string(reinterpret_cast<const char*>(sizes), sizeof sizes) +
           std::string(reinterpret_cast<const char*>(packed.data()), packed.size());
}

TEST(Pcd, AsciiBinaryAndCompressedHoldTheSamePoints) {
    expect_the_two_points(
        scans_from(pcd_header("2", "ascii") + "1 2 3 1056816 0 0 1 500\n4,5,6,16711681,1,0,0,7"));
    expect_the_two_points(scans_from(binary_pcd()));
    expect_the_two_points(scans_from(compressed_pcd()));
}

TEST(Pcd, ViewpointIsThePoseUnlessItIsTheDefault) {
    const double h = std::numbers::sqrt2 / 2;
    const auto scans = scans_from(
        pcd_header("1", "ascii", "10 20 30 0.70710678118654752 0 0 0.70710678118654752") +
        "1 2 3 0 0 0 1 0\n");
    ASSERT_TRUE(scans[0].T_world_scan.has_value());
    const Eigen::Vector3d world = *scans[0].T_world_scan * Eigen::Vector3d(1, 0, 0);
    EXPECT_NEAR((world - Eigen::Vector3d(10, 21, 30)).norm(), 0.0, 1e-12) << h;
    EXPECT_TRUE(scans[0].has_viewpoint);
    EXPECT_FALSE(scans_from(pcd_header("1", "ascii", "0 0 0 0 0 0 0") + "1 2 3 0 0 0 1 0\n")[0]
                     .T_world_scan);
}

TEST(Pcd, ColoursPackedInAFloatReadAsPclPrintsThem) {
    const std::string head =
        "VERSION .7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F F\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT "
        "1\nPOINTS 2\n"
        "DATA ascii\n";
    const auto scans = scans_from(head + "1 2 3 4210752.0\n1 2 4 1056816\n");
    EXPECT_EQ(scans[0].points.colours[0], (Rgb8{128, 128, 128}));  // the bits of a float
    EXPECT_EQ(scans[0].points.colours[1], (Rgb8{0x10, 0x20, 0x30}));
}

TEST(Pcd, LargeAsciiCoordinatesKeepMillimetresThoughDeclaredFloat) {
    const auto scans = scans_from(
        "VERSION 0.7\nFIELDS X Y Z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS "
        "2\nDATA ascii\n"
        "289814.153 4320978.617 170.761\n289815.153 4320979.617 171.761\n");
    const Vec3d point = scans[0].offset + vec3_cast<double>(scans[0].points.positions[0]);
    EXPECT_NEAR(length(point - Vec3d{289814.153, 4320978.617, 170.761}), 0.0, 1e-6);
}

TEST(Pcd, HostileHeadersAreRefusedBeforeMemoryIsTaken) {
    for (const char* count : {"3", "2147483648", "18446744073709551615"}) {
        std::string content = binary_pcd();
        for (const char* key : {"WIDTH 2", "POINTS 2"}) {
            const std::string name(key, std::strlen(key) - 1);
            content.replace(content.find(key), std::strlen(key), name + count);
        }
        EXPECT_EQ(outcome_of(content).code, ExitCode::kUnreadable) << count;
    }
    std::string content = compressed_pcd();
    const std::size_t sizes = content.find("binary_compressed\n") + 18;
    content.replace(sizes, 8, std::string(8, '\xff'));
    EXPECT_EQ(outcome_of(content).code, ExitCode::kUnreadable);
    for (const char* text :
         {"# .PCD v0.7\n", "# .PCD v0.7\nDATA ascii\n1 2 3\n",
          "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n",
          "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n",
          "# .PCD v0.7\nFIELDS x y\nSIZE 4 4\nTYPE F F\nPOINTS 1\nDATA ascii\n1 2\n",
          "# .PCD v0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA xml\n1 2 3\n"}) {
        EXPECT_EQ(outcome_of(text).code, ExitCode::kUnreadable) << text;
    }
    EXPECT_EQ(outcome_of(pcd_header("0", "binary")).code, ExitCode::kDegenerate);
}

TEST(Lzf, DecodesWhatItEncodesAndNothingElse) {
    std::mt19937 random(7);
    for (const int spread : {1, 3, 256}) {
        for (const std::size_t size : {0u, 1u, 2u, 3u, 33u, 300u, 20000u}) {
            std::vector<std::byte> input(size);
            for (std::byte& byte : input)
                byte = static_cast<std::byte>(static_cast<int>(random()) % spread);
            const auto packed = encode_lzf(input);
            EXPECT_LE(input.size(), kLzfLargestExpansion * packed.size());
            std::vector<std::byte> output(size);
            EXPECT_TRUE(decode_lzf(packed, output));
            EXPECT_EQ(input, output) << spread << " " << size;
            output.push_back({});
            EXPECT_FALSE(decode_lzf(packed, output)) << "one byte too many asked for";
            if (size > 0) {
                output.resize(size - 1);
                EXPECT_FALSE(decode_lzf(packed, output)) << "one byte too few asked for";
            }
        }
    }
}

}  // namespace
}  // namespace glowworm
