// Clouds written as LAS and E57, read back by our readers.

#include <Eigen/Geometry>
#include <random>

#include "las_bytes.h"
#include "preprocess/read/las_header.h"
#include "preprocess/write/cloud_writer.h"
#include "scan_text.h"

namespace glowworm::testing {
namespace {

Eigen::Isometry3d pose_of(const Station& station) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(station.rotation[3], station.rotation[0],
                                       station.rotation[1], station.rotation[2])
                        .toRotationMatrix();
    pose.translation() =
        Eigen::Vector3d(station.position.x, station.position.y, station.position.z);
    return pose;
}

/// Three stations around a georeferenced origin, the last without points.
PointCloud some_cloud(std::size_t count) {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> unit(0.0f, 1.0f);
    PointCloud cloud;
    cloud.origin = {431000.0, 5321000.0, 900.0};
    for (int i = 0; i < 3; ++i) {
        Station station;
        station.position = cloud.origin + Vec3d{10.0 * i, -3.0, 1.5};
        const Eigen::Quaterniond q =
            Eigen::Quaterniond(unit(random) - 0.5, unit(random), unit(random), unit(random))
                .normalized();
        station.rotation[0] = q.x();
        station.rotation[1] = q.y();
        station.rotation[2] = q.z();
        station.rotation[3] = q.w();
        station.name = "грот & <" + std::to_string(i) + ">\x01\xff";
        cloud.stations.push_back(station);
    }
    for (std::size_t i = 0; i < count; ++i) {
        Points& points = cloud.points;
        points.positions.push_back(
            {40.0f * unit(random) - 10.0f, 20.0f * unit(random), 5.0f * unit(random)});
        points.colours.push_back({static_cast<std::uint8_t>(random()),
                                  static_cast<std::uint8_t>(random()),
                                  static_cast<std::uint8_t>(random())});
        points.intensities.push_back(unit(random));
        points.normals.push_back(
            normalized(Vec3f{unit(random) - 0.5f, unit(random), unit(random)}));
        points.stations.push_back(static_cast<std::uint32_t>(random() % 2));
        points.times.push_back(0.125 * static_cast<double>(i));
    }
    return cloud;
}

TEST(WriteE57, EveryStationComesBackAsAScanWithItsPose) {
    const PointCloud cloud = some_cloud(20000);
    const ScratchFolder folder;
    write_cloud(cloud, folder / "cloud.e57");
    const std::vector<Scan> scans = read_scans(folder / "cloud.e57");
    ASSERT_EQ(scans.size(), 2u) << "the third has no points";
    double worst_place = 0.0, worst_normal = 0.0;
    for (std::uint32_t station = 0; station < 2; ++station) {
        const Scan& scan = scans[station];
        ASSERT_TRUE(scan.T_world_scan.has_value());
        EXPECT_TRUE(scan.T_world_scan->isApprox(pose_of(cloud.stations[station]), 1e-12));
        std::size_t next = 0;
        for (std::size_t i = 0; i < cloud.points.size(); ++i) {
            if (cloud.points.stations[i] != station) continue;
            ASSERT_LT(next, scan.points.size());
            const Vec3d in_scan = scan.offset + vec3_cast<double>(scan.points.positions[next]);
            const Eigen::Vector3d world =
                *scan.T_world_scan * Eigen::Vector3d(in_scan.x, in_scan.y, in_scan.z);
            const Vec3d truth = cloud.origin + vec3_cast<double>(cloud.points.positions[i]);
            worst_place =
                std::max(worst_place, (world - Eigen::Vector3d(truth.x, truth.y, truth.z)).norm());
            const Vec3f& n = scan.points.normals[next];
            const Eigen::Vector3d normal =
                scan.T_world_scan->linear() * Eigen::Vector3f(n.x, n.y, n.z).cast<double>();
            const Vec3f& m = cloud.points.normals[i];
            worst_normal = std::max(
                worst_normal, (normal - Eigen::Vector3f(m.x, m.y, m.z).cast<double>()).norm());
            EXPECT_EQ(scan.points.colours[next], cloud.points.colours[i]);
            EXPECT_FLOAT_EQ(scan.points.intensities[next], cloud.points.intensities[i]);
            EXPECT_EQ(scan.points.times[next], cloud.points.times[i]);
            ++next;
        }
        EXPECT_EQ(next, scan.points.size());
    }
    EXPECT_LT(worst_place, 1e-5) << "m";
    EXPECT_LT(worst_normal, 1e-6);
}

TEST(WriteE57, RowsAndColumnsOfOrganisedScansComeBack) {
    PointCloud cloud = some_cloud(3000);
    for (std::uint32_t i = 0; i < 3000; ++i)
        cloud.points.grid.push_back({100000 + i % 7, i / 7});
    const ScratchFolder folder;
    write_cloud(cloud, folder / "cloud.e57");
    const std::vector<Scan> scans = read_scans(folder / "cloud.e57");
    std::size_t next[2] = {0, 0};
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const std::uint32_t station = cloud.points.stations[i];
        ASSERT_EQ(scans[station].points.grid.at(next[station]++), cloud.points.grid[i]);
    }
    // A scan without rows and columns takes them from the whole, as with every other column.
    cloud.points.append(some_cloud(1).points);
    EXPECT_TRUE(cloud.points.grid.empty());
}

TEST(WriteE57, NamesAreWhatXmlAllows) {
    const PointCloud cloud = some_cloud(10);
    const ScratchFolder folder;
    write_cloud(cloud, folder / "cloud.E57");
    const auto file = open_scan_file(folder / "cloud.E57");
    ScanHeader header;
    ASSERT_TRUE(file->next_scan(header));
    EXPECT_EQ(header.name, "грот & <0>??");
    EXPECT_EQ(header.metadata[0].second, "Glowworm " GLOWWORM_VERSION);
    EXPECT_TRUE(file->next_scan(header));
    EXPECT_TRUE(file->next_scan(header));
    EXPECT_EQ(header.declared_points, 0u);
    EXPECT_FALSE(file->next_scan(header));
}

TEST(WriteE57, CloudsWithoutStationsAndScansOfKilometresKeepTheirPlaces) {
    PointCloud cloud;
    cloud.origin = {500000.0, 0.0, 0.0};
    cloud.points.positions = {{0.25f, 0.5f, 0.75f}, {2500.125f, -2000.0f, 1.0f}};
    const ScratchFolder folder;
    write_cloud(cloud, folder / "far.e57");
    const std::vector<Scan> scans = read_scans(folder / "far.e57");
    ASSERT_EQ(scans.size(), 1u);
    EXPECT_EQ(scans[0].T_world_scan->translation().x(), 500000.0);
    EXPECT_EQ(scans[0].offset.x + static_cast<double>(scans[0].points.positions[1].x), 2500.125);
}

TEST(WriteLas, PointsComeBackWithinAHundredthOfAMillimetre) {
    const PointCloud cloud = some_cloud(70000);
    const ScratchFolder folder;
    write_cloud(cloud, folder / "cloud.las");
    const InputFile file(folder / "cloud.las");
    const LasHeader header = read_las_header(file);
    EXPECT_EQ(header.point_format, 7u);
    EXPECT_EQ(header.version_minor, 4);
    EXPECT_EQ(header.scale.x, 1e-5);
    EXPECT_EQ(header.offset, cloud.origin);
    const std::vector<Scan> scans = read_scans(folder / "cloud.las");
    ASSERT_EQ(scans[0].points.size(), cloud.points.size());
    double worst = 0.0, worst_intensity = 0.0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const Vec3d read = scans[0].offset + vec3_cast<double>(scans[0].points.positions[i]);
        worst = std::max(
            worst, length(read - cloud.origin - vec3_cast<double>(cloud.points.positions[i])));
        worst_intensity = std::max<double>(
            worst_intensity,
            std::abs(scans[0].points.intensities[i] / 65535.0f - cloud.points.intensities[i]));
        EXPECT_EQ(scans[0].points.colours[i], cloud.points.colours[i]);
        EXPECT_EQ(scans[0].points.normals[i], cloud.points.normals[i]);
        EXPECT_EQ(scans[0].points.times[i], cloud.points.times[i]);
        const Vec3d place = cloud.origin + vec3_cast<double>(cloud.points.positions[i]);
        EXPECT_TRUE(place.x > header.bounds_min.x - 1e-5 && place.x < header.bounds_max.x + 1e-5);
    }
    EXPECT_LT(worst, 1.2e-5) << "m";
    EXPECT_LT(worst_intensity, 1e-5);
}

TEST(WriteLas, TheStepGrowsWithTheCloud) {
    PointCloud cloud;
    cloud.points.positions = {{0.0f, 0.0f, 0.0f}, {-3.0e6f, 1.0f, 2.0f}};
    const ScratchFolder folder;
    write_cloud(cloud, folder / "wide.las");
    const LasHeader header = read_las_header(InputFile(folder / "wide.las"));
    EXPECT_DOUBLE_EQ(header.scale.x, 1e-2);
    EXPECT_EQ(header.point_format, 6u);
    EXPECT_NEAR(header.bounds_min.x, -3.0e6, 0.01);
}

TEST(WriteFormats, TheSameCloudGivesTheSameBytesAndNoLeftovers) {
    const PointCloud cloud = some_cloud(3000);
    for (const char* name : {"cloud.las", "cloud.e57"}) {
        const ScratchFolder folder, other;
        write_cloud(cloud, folder / name);
        write_cloud(cloud, other / name);
        EXPECT_TRUE(file_content(folder / name) == file_content(other / name)) << name;
        write_cloud(cloud, folder / name);
        std::size_t files = 0;
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            files += entry.is_regular_file() ? 1u : 0u;
        }
        EXPECT_EQ(files, 1u) << name;
    }
}

TEST(WriteFormats, AnEmptyCloudIsAFileWithoutPoints) {
    const ScratchFolder folder;
    for (const char* name : {"empty.las", "empty.e57"}) {
        write_cloud({}, folder / name);
        EXPECT_EQ(outcome_of_reading(folder / name).code, ExitCode::kDegenerate) << name;
    }
}

}  // namespace
}  // namespace glowworm::testing
