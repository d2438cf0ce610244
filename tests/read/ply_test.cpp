#include <cstring>

#include "scan_text.h"

namespace glowworm {
namespace {

using testing::outcome_of;
using testing::scans_from;

template <typename T>
std::string bytes_of(T value, bool swapped = false) {
    std::string bytes(sizeof value, '\0');
    std::memcpy(bytes.data(), &value, sizeof value);
    return swapped ? std::string(bytes.rbegin(), bytes.rend()) : bytes;
}

std::string mixed_ply(bool big) {
    std::string content =
        std::string("ply\r\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\r\ncomment a wall\r\nelement camera 1\r\nproperty list uchar int ids\r\n"
        "property float focus\r\nelement vertex 2\r\nproperty ushort red\r\n"
        "property double z\r\nproperty list ushort double weights\r\nproperty double y\r\n"
        "property ushort green\r\nproperty float x\r\nproperty ushort blue\r\n"
        "property short scalar_Intensity\r\nelement face 1\r\n"
        "property list uchar int vertex_indices\r\nend_header\r\n";
    content +=
        bytes_of<std::uint8_t>(2) + bytes_of(7, big) + bytes_of(8, big) + bytes_of(1.5f, big);
    for (int i = 0; i < 2; ++i) {
        content += bytes_of<std::uint16_t>(65535, big) + bytes_of(3.25 + i, big);
        content += bytes_of<std::uint16_t>(static_cast<std::uint16_t>(i), big);
        if (i == 1) content += bytes_of(0.5, big);
        content += bytes_of(2.5, big) + bytes_of<std::uint16_t>(256, big) + bytes_of(1.0f, big);
        content += bytes_of<std::uint16_t>(0, big) + bytes_of<std::int16_t>(-7, big);
    }
    return content + bytes_of<std::uint8_t>(3) + std::string(12, '\0');
}

TEST(Ply, AnyPropertyOrderTypeAndByteOrderReadsTheSame) {
    for (const bool big : {false, true}) {
        const std::vector<Scan> scans = scans_from(mixed_ply(big));
        ASSERT_EQ(scans.size(), 1u);
        const Points& points = scans[0].points;
        ASSERT_EQ(points.size(), 2u);
        EXPECT_EQ(points.positions[1], (Vec3f{1.0f, 2.5f, 4.25f}));
        EXPECT_EQ(points.colours[0], (Rgb8{255, 1, 0}));
        EXPECT_EQ(points.intensities[1], -7.0f);
        EXPECT_TRUE(points.normals.empty());
    }
}

TEST(Ply, AsciiSkipsListsFacesAndBlankLines) {
    const auto scans = scans_from(
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty list uchar int tags\n"
        "property float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
        "nz\n"
        "property float r\nproperty float g\nproperty float b\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n"
        "1 2 9 9 2 3 0 0 1 1.0 0.5 0\n\n+4 0 5e0 6 0 1 0 0 0 0\n3 0 1 2\n");
    ASSERT_EQ(scans[0].points.size(), 2u);
    EXPECT_EQ(scans[0].points.positions[0], (Vec3f{1, 2, 3}));
    EXPECT_EQ(scans[0].points.positions[1], (Vec3f{4, 5, 6}));
    EXPECT_EQ(scans[0].points.normals[1], (Vec3f{0, 1, 0}));
    EXPECT_EQ(scans[0].points.colours[0], (Rgb8{255, 128, 0}));
}

TEST(Ply, OldMacLineEndsDoNotSwallowThePoints) {
    std::string content =
        "ply\rformat binary_little_endian 1.0\relement vertex 1\rproperty float x\rproperty float "
        "y\r"
        "property float z\rend_header\r";
    // The first byte of the point is a \n, which must not be taken for the end of a \r\n.
    content += std::string("\n\0\0\0", 4) + bytes_of(2.0f) + bytes_of(3.0f);
    EXPECT_EQ(scans_from(content)[0].points.positions[0].z, 3.0f);
}

TEST(Ply, CountsThatLieAreRefusedBeforeMemoryIsTaken) {
    const std::string head = "ply\nformat binary_little_endian 1.0\nelement vertex ";
    const std::string tail = "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const char* count :
         {"2", "2147483648", "4294967295", "9223372036854775808", "18446744073709551615"}) {
        const auto outcome = outcome_of(head + count + tail + std::string(12, '\0'));
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable) << count;
        EXPECT_NE(outcome.sentence.find("announces"), std::string::npos) << outcome.sentence;
    }
    EXPECT_EQ(outcome_of(head + "-1" + tail).code, ExitCode::kUnreadable);
    EXPECT_EQ(outcome_of(head + "1" + tail + std::string(12, '\0')).code, ExitCode::kDone);
    EXPECT_EQ(outcome_of(head + "0" + tail).code, ExitCode::kDegenerate);
}

TEST(Ply, AListWithoutEndIsRefused) {
    const std::string content =
        "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint double v\n"
        "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n" +
        bytes_of(0xffffffffu) + std::string(100, '\0');
    EXPECT_EQ(outcome_of(content).code, ExitCode::kUnreadable);
}

TEST(Ply, PointsWithoutPositionsAndBrokenHeadersGetASentence) {
    for (const char* content :
         {"ply\n", "ply\nformat ascii 1.0\n", "ply\nend_header\n",
          "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n1\n",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
          "y\nend_header\n1 1\n",
          "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n\n",
          "ply\nformat utf8 1.0\nelement vertex 1\nend_header\n\n",
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty "
          "float z\n"
          "end_header\n1 two 3\n"}) {
        const auto outcome = outcome_of(content);
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable) << content;
        EXPECT_NE(outcome.sentence.find("cannot read '"), std::string::npos) << outcome.sentence;
    }
}

}  // namespace
}  // namespace glowworm
