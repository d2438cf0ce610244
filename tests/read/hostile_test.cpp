#include "hostile.h"

#include "preprocess/write/cloud_writer.h"

namespace glowworm {
namespace {

using testing::file_content;
using testing::refused_when_cut;
using testing::refused_when_flipped;
using testing::refused_when_overwritten;
using testing::ScratchFolder;

const std::string kAsciiPly =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty list uchar int "
    "t\nproperty float y\n"
    "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    "1 2 5 6 2 3 9 8 7\n4 0 5 6 1 2 3\n";

const std::string kAsciiPcd =
    "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\nWIDTH 2\nHEIGHT 1\n"
    "VIEWPOINT 1 2 3 1 0 0 0\nPOINTS 2\nDATA ascii\n1 2 3 4\n5 6 7 8\n";

const std::string kPtx =
    "2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 2 3 1\n1 2 3 0.5 9 8 7\n4 5 6 "
    "0.5 6 5 4\n"
    "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n4 5 6 1\n1 2 3 0.5 9 8 7\n";

const std::string kPts = "2\n1 2 3 -5 9 8 7\n4 5 6 -6 6 5 4\n1\n7 8 9 -7 3 2 1\n";

const std::string kCsv = "x;y;z;Intensity;R;G;B\n1,5;2;3;4;9;8;7\n2,5;3;4;5;6;5;4\n";

std::string cloud_file(const char* extension) {
    PointCloud cloud;
    cloud.origin = {1000, 2000, 3000};
    cloud.stations = {{.position = {1, 2, 3}, .name = "a"}};
    for (int i = 0; i < 4; ++i) {
        cloud.points.positions.push_back({static_cast<float>(i), 1, 2});
        cloud.points.normals.push_back({0, 0, 1});
        cloud.points.colours.push_back({1, 2, 3});
        cloud.points.stations.push_back(0);
    }
    const ScratchFolder folder;
    const auto path = folder / (std::string("cloud") + extension);
    write_cloud(cloud, path);
    return file_content(path);
}

/// The same columns as a compressed PCD of four points at a line, as another program writes it.
std::string compressed_pcd() {
    std::string content =
        "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH "
        "4\nHEIGHT 1\n"
        "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 4\nDATA binary_compressed\n";
    // Four literal bytes of 1.0f, then a reference that repeats them 44 bytes long.
    const std::string packed("\x03\x00\x00\x80\x3f\xe0\x23\x03", 8);
    const std::uint32_t sizes[2] = {static_cast<std::uint32_t>(packed.size()), 48};
    return content.append(reinterpret_cast<const char*>(sizes), sizeof sizes) + packed;
}

struct Sample {
    const char* name;
    std::string content;
    std::size_t fewest_cut_refused;  // of the cuts, at least
};

std::vector<Sample> samples() {
    const std::string ply = cloud_file(".ply"), pcd = cloud_file(".pcd"), packed = compressed_pcd();
    return {{"ply ascii", kAsciiPly, kAsciiPly.size() - 3},
            {"ply binary", ply, ply.size()},
            {"pcd ascii", kAsciiPcd, kAsciiPcd.size() - 6},
            {"pcd binary", pcd, pcd.size()},
            {"pcd compressed", packed, packed.size()},
            {"ptx", kPtx, 80},
            {"pts", kPts, 4},
            {"csv", kCsv, 20}};
}

TEST(Hostile, FilesCutOffAtEveryByteEndInAnErrorOrInPoints) {
    for (const Sample& sample : samples()) {
        ASSERT_EQ(testing::outcome_of(sample.content).sentence, "") << sample.name;
        const std::size_t refused = refused_when_cut(sample.content);
        std::printf("%-15s %zu of %zu cuts refused\n", sample.name, refused, sample.content.size());
        EXPECT_GE(refused, sample.fewest_cut_refused) << sample.name;
    }
}

TEST(Hostile, FilesWithAFlippedBitEndInAnErrorOrInPoints) {
    for (const Sample& sample : samples()) {
        const std::size_t refused = refused_when_flipped(sample.content, 0, sample.content.size());
        std::printf("%-15s %zu of %zu flips refused\n", sample.name, refused,
                    8 * sample.content.size());
        EXPECT_GT(refused, 0u) << sample.name;
        EXPECT_LT(refused, 8 * sample.content.size()) << sample.name;
    }
}

TEST(Hostile, FilesOverwrittenInPlacesEndInAnErrorOrInPoints) {
    for (const Sample& sample : samples()) {
        const std::size_t refused = refused_when_overwritten(sample.content, 3);
        std::printf("%-15s %zu overwritten ones refused\n", sample.name, refused);
        EXPECT_GT(refused, 0u) << sample.name;
    }
}

}  // namespace
}  // namespace glowworm
