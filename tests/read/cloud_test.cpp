#include <random>

#include "preprocess/write/cloud_writer.h"
#include "scan_text.h"

namespace glowworm {
namespace {

using testing::ScratchFolder;
using testing::write_file;

PointCloud some_cloud(std::size_t count) {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
    PointCloud cloud;
    cloud.origin = {512345.25, 5412345.1, -17.3};
    cloud.stations = {
        {.position = {512300.1, 5412300.2, -12.0 / 7},
         .rotation = {0.1, 0.2, 0.3, 0.927361849549570375},
         .has_viewpoint = true,
         .name = "  tunnel 50% north\n.e57 "},
        {.position = {}, .rotation = {0, 0, 0, 1}, .has_viewpoint = false, .name = ""}};
    cloud.area_lights = {{.name = "red panel",
                          .corners = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {1.0 / 3, 1e-9, -1e9}},
                          .radiance = {0.1f, 2.0f, 3e7f}}};
    Points& p = cloud.points;
    for (std::size_t i = 0; i < count; ++i) {
        p.positions.push_back({10 * unit(random), 10 * unit(random), unit(random)});
        p.normals.push_back(normalized(Vec3f{unit(random), unit(random), unit(random)}));
        p.colours.push_back({static_cast<std::uint8_t>(random()),
                             static_cast<std::uint8_t>(random()),
                             static_cast<std::uint8_t>(random())});
        p.intensities.push_back(100 * unit(random));
        p.ndf_lengths.push_back(std::abs(unit(random)));
        p.radii.push_back(std::abs(unit(random)));
        p.stations.push_back(static_cast<std::uint32_t>(random() % 2));
        p.emissions.push_back({unit(random), unit(random), unit(random)});
        p.times.push_back(1e9 + unit(random));
    }
    return cloud;
}

void expect_same(const PointCloud& a, const PointCloud& b) {
    EXPECT_EQ(a.origin, b.origin);
    EXPECT_EQ(a.points.positions, b.points.positions);
    EXPECT_EQ(a.points.normals, b.points.normals);
    EXPECT_EQ(a.points.colours, b.points.colours);
    EXPECT_EQ(a.points.intensities, b.points.intensities);
    EXPECT_EQ(a.points.ndf_lengths, b.points.ndf_lengths);
    EXPECT_EQ(a.points.radii, b.points.radii);
    EXPECT_EQ(a.points.stations, b.points.stations);
    EXPECT_EQ(a.points.emissions, b.points.emissions);
    EXPECT_EQ(a.points.times, b.points.times);
    ASSERT_EQ(a.stations.size(), b.stations.size());
    for (std::size_t i = 0; i < a.stations.size(); ++i) {
        EXPECT_EQ(a.stations[i].position, b.stations[i].position);
        EXPECT_TRUE(std::ranges::equal(a.stations[i].rotation, b.stations[i].rotation));
        EXPECT_EQ(a.stations[i].has_viewpoint, b.stations[i].has_viewpoint);
        EXPECT_EQ(a.stations[i].name, b.stations[i].name);
    }
    ASSERT_EQ(a.area_lights.size(), b.area_lights.size());
    for (std::size_t i = 0; i < a.area_lights.size(); ++i) {
        EXPECT_TRUE(std::ranges::equal(a.area_lights[i].corners, b.area_lights[i].corners));
        EXPECT_EQ(a.area_lights[i].radiance, b.area_lights[i].radiance);
        EXPECT_EQ(a.area_lights[i].name, b.area_lights[i].name);
    }
}

class WrittenCloud : public ::testing::TestWithParam<const char*> {};

TEST_P(WrittenCloud, ComesBackBitForBit) {
    const ScratchFolder folder;
    const auto path = folder / (std::string("cloud") + GetParam());
    const PointCloud cloud = some_cloud(70000);  // more than a block
    write_cloud(cloud, path);
    expect_same(cloud, read_cloud(path));

    PointCloud bare;
    bare.points.positions = {{1, 2, 3}};
    write_cloud(bare, path);
    expect_same(bare, read_cloud(path));
}

TEST_P(WrittenCloud, TwiceIsTheSameBytes) {
    const ScratchFolder folder;
    const std::string extension = GetParam();
    write_cloud(some_cloud(100), folder / ("a" + extension));
    write_cloud(some_cloud(100), folder / ("b" + extension));
    EXPECT_EQ(testing::file_content(folder / ("a" + extension)),
              testing::file_content(folder / ("b" + extension)));
}

INSTANTIATE_TEST_SUITE_P(Formats, WrittenCloud, ::testing::Values(".ply", ".pcd"));

TEST(WriteCloud, AnExtensionThatNamesNoFormatIsWrongUsage) {
    const ScratchFolder folder;
    try {
        write_cloud(some_cloud(1), folder / "cloud.obj");
        FAIL() << "nothing was thrown";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ExitCode::kUsage);
        EXPECT_NE(std::string(error.what()).find(".ply"), std::string::npos);
    }
    EXPECT_NO_THROW(check_cloud_extension("x/cloud.PLY"));
}

TEST(ReadCloud, AStationThatIsNotThereIsRefusedAndOtherProgramsNumbersAreIgnored) {
    const ScratchFolder folder;
    PointCloud cloud = some_cloud(5);
    cloud.points.stations[3] = 2;
    write_cloud(cloud, folder / "cloud.ply");
    EXPECT_THROW(read_cloud(folder / "cloud.ply"), Error);
    cloud.stations.clear();
    write_cloud(cloud, folder / "cloud.ply");
    EXPECT_TRUE(read_cloud(folder / "cloud.ply").points.stations.empty());
}

TEST(ReadCloud, CoordinatesOfOthersInDoubleBecomeOriginAndFloat) {
    const ScratchFolder folder;
    const auto path =
        write_file(folder / "utm.ply",
                   "ply\nformat ascii 1.0\ncomment origin is in the north\nelement vertex 1\n"
                   "property double x\nproperty double y\nproperty double z\nend_header\n"
                   "500000.1234 5400000.4321 812.5005\n");
    const PointCloud cloud = read_cloud(path);
    const Vec3d point = cloud.origin + vec3_cast<double>(cloud.points.positions[0]);
    EXPECT_NEAR(length(point - Vec3d{500000.1234, 5400000.4321, 812.5005}), 0.0, 1e-6);
}

}  // namespace
}  // namespace glowworm
