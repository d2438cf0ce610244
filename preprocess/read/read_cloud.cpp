#include <algorithm>
#include <utility>

#include "octree/error.h"
#include "preprocess/read/append_block.h"
#include "preprocess/read/read_scans.h"

namespace glowworm {
namespace {

Station station_at(const Eigen::Isometry3d& T_world_scan, const ScanHeader& header,
                   const std::filesystem::path& path) {
    const Eigen::Vector3d p = T_world_scan.translation();
    const Eigen::Quaterniond q(T_world_scan.linear());
    return {.position = {p.x(), p.y(), p.z()},
            .rotation = {q.x(), q.y(), q.z(), q.w()},
            .has_viewpoint = header.has_viewpoint,
            .name = header.name.empty() ? path.filename().string() : header.name};
}

void transform(const Eigen::Isometry3d& T_world_scan, PointBlock& block) {
    const Eigen::Matrix3d R = T_world_scan.linear();
    for (Vec3d& p : block.positions) {
        const Eigen::Vector3d q = T_world_scan * Eigen::Vector3d(p.x, p.y, p.z);
        p = {q.x(), q.y(), q.z()};
    }
    for (Vec3f& n : block.normals) {
        const Eigen::Vector3d q = R * Eigen::Vector3d(n.x, n.y, n.z);
        n = vec3_cast<float>(Vec3d{q.x(), q.y(), q.z()});
    }
}

/// Appends the points of one scan in the world, `cloud.origin` taken out. The first points of the
/// cloud choose the origin.
Points read_world_points(ScanFile& file, const ScanHeader& header, PointCloud& cloud, bool& chosen,
                         ScanCounts& counts, const Progress& progress) {
    Points points;
    PointBlock block;
    while (file.next_block(block)) {
        counts.invalid += block.invalid;
        counts.no_colour += block.no_colour;
        counts.no_intensity += block.no_intensity;
        counts.not_finite += drop_not_finite(block);
        counts.too_far += drop_too_far(block);
        if (block.size() == 0) continue;
        if (header.T_world_scan) transform(*header.T_world_scan, block);
        if (!std::exchange(chosen, true)) cloud.origin = header.origin + choose_offset(block);
        append_block(block, cloud.origin - header.origin, points);
        const std::uint64_t read = cloud.points.size() + points.size();
        if (progress) progress(read, std::max(read, header.declared_points));
    }
    counts.kept = points.size();
    return points;
}

/// The column says which station a point was seen from; each must be there.
void check_stations(PointCloud& cloud, const std::filesystem::path& path) {
    if (cloud.points.stations.empty()) return;
    if (cloud.stations.empty()) {
        cloud.points.stations.clear();  // another program's numbers
        return;
    }
    const std::uint32_t largest = *std::ranges::max_element(cloud.points.stations);
    if (largest >= cloud.stations.size()) {
        throw Error(ExitCode::kUnreadable,
                    "cannot read '" + path.string() + "': a point of it was seen from station " +
                        std::to_string(largest) + " but it names only " +
                        std::to_string(cloud.stations.size()) + "; merge the scans again");
    }
}

}  // namespace

PointCloud read_cloud(const std::filesystem::path& path, const ReadSettings& settings,
                      ReadReport* report, const Progress& progress) {
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    ReadReport local;
    ReadReport& said = report != nullptr ? *report : local;
    said = {.format = file->format(), .scans = {}, .notes = {}};

    PointCloud cloud;
    bool chosen = false;
    ScanHeader header;
    while (file->next_scan(header)) {
        ScanCounts& counts = said.scans.emplace_back();
        counts.name = header.name;
        counts.declared = header.declared_points;
        said.notes.insert(said.notes.end(), header.notes.begin(), header.notes.end());
        Points points = read_world_points(*file, header, cloud, chosen, counts, progress);
        if (header.T_world_scan) {
            points.stations.assign(points.size(),
                                   static_cast<std::uint32_t>(cloud.stations.size()));
            cloud.stations.push_back(station_at(*header.T_world_scan, header, path));
        } else if (!header.stations.empty()) {
            cloud.stations = header.stations;
        }
        cloud.area_lights.insert(cloud.area_lights.end(), header.area_lights.begin(),
                                 header.area_lights.end());
        if (cloud.points.empty())
            cloud.points = std::move(points);
        else
            cloud.points.append(points);
    }
    if (cloud.points.empty()) {
        throw Error(ExitCode::kDegenerate, "'" + path.string() + "' " + why_no_points(said));
    }
    check_stations(cloud, path);
    return cloud;
}

}  // namespace glowworm
