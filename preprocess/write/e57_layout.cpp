#include "preprocess/write/e57_layout.h"

#include <algorithm>
#include <cmath>

namespace glowworm {
namespace {

constexpr std::size_t kMaxPacketBytes = 65536;
constexpr double kFloatReach = 1000.0;  // m: float's step is 0.06 mm there

constexpr std::size_t padded(std::size_t bytes) {
    return (bytes + 3) / 4 * 4;
}

}  // namespace

Vec3d rotate_to_station(const Station& station, const Vec3d& direction) {
    // v + 2 u x (u x v + w v) turns by the quaternion (u, w); its conjugate turns back.
    const Vec3d u{-station.rotation[0], -station.rotation[1], -station.rotation[2]};
    return direction + 2.0 * cross(u, cross(u, direction) + station.rotation[3] * direction);
}

Vec3d to_station(const Station& station, const Vec3d& world) {
    return rotate_to_station(station, world - station.position);
}

std::size_t E57ScanLayout::field_count() const {
    return 3 + (colours ? 3 : 0) + (intensities ? 1 : 0) + (normals ? 3 : 0) + (times ? 1 : 0) +
           (grid ? 2 : 0);
}

std::size_t E57ScanLayout::record_bytes() const {
    return (doubles ? 24 : 12) + (colours ? 3 : 0) + (intensities ? 4 : 0) + (normals ? 12 : 0) +
           (times ? 8 : 0) + (grid ? 8 : 0);
}

std::size_t E57ScanLayout::packet_records() const {
    return (kMaxPacketBytes - 6 - 2 * field_count()) / record_bytes();
}

std::size_t E57ScanLayout::packet_count() const {
    return std::max<std::size_t>(1, (indices.size() + packet_records() - 1) / packet_records());
}

std::size_t E57ScanLayout::packet_bytes(std::size_t packet) const {
    const std::size_t first = packet * packet_records();
    const std::size_t records = std::min(packet_records(), indices.size() - first);
    return padded(6 + 2 * field_count() + records * record_bytes());
}

std::uint64_t E57ScanLayout::content_bytes() const {
    const std::size_t packets = packet_count();
    return std::uint64_t{packets - 1} * packet_bytes(0) + packet_bytes(packets - 1);
}

std::vector<E57ScanLayout> lay_out_e57(const PointCloud& cloud, const std::string& name) {
    const Points& points = cloud.points;
    const bool split = !points.stations.empty() && !cloud.stations.empty();
    std::vector<E57ScanLayout> scans(split ? cloud.stations.size() : 1);
    for (std::size_t i = 0; i < scans.size(); ++i) {
        E57ScanLayout& scan = scans[i];
        if (split || cloud.stations.size() == 1) {
            scan.station = cloud.stations[i];
        } else {
            scan.station.position = cloud.origin;
        }
        if (scan.station.name.empty()) scan.station.name = name;
        scan.colours = !points.colours.empty();
        scan.intensities = !points.intensities.empty();
        scan.normals = !points.normals.empty();
        scan.times = !points.times.empty();
        scan.grid = !points.grid.empty();
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t station =
            split ? std::min<std::size_t>(points.stations[i], scans.size() - 1) : 0;
        E57ScanLayout& scan = scans[station];
        const Vec3d position =
            to_station(scan.station, cloud.origin + vec3_cast<double>(points.positions[i]));
        const bool first = scan.indices.empty();
        scan.least = first ? position : component_min(scan.least, position);
        scan.most = first ? position : component_max(scan.most, position);
        if (scan.intensities) {
            const float value = points.intensities[i];
            scan.least_intensity = first ? value : std::min(scan.least_intensity, value);
            scan.most_intensity = first ? value : std::max(scan.most_intensity, value);
        }
        if (scan.grid) {
            const GridCell& cell = points.grid[i];
            if (first) scan.first_cell = scan.last_cell = cell;
            scan.first_cell = {std::min(scan.first_cell.row, cell.row),
                               std::min(scan.first_cell.column, cell.column)};
            scan.last_cell = {std::max(scan.last_cell.row, cell.row),
                              std::max(scan.last_cell.column, cell.column)};
        }
        scan.indices.push_back(static_cast<std::uint32_t>(i));
    }
    std::uint64_t at = kE57HeaderBytes;
    for (E57ScanLayout& scan : scans) {
        // Those of 0..1 stay as they are for readers that scale by the limits.
        if (scan.least_intensity >= 0.0f && scan.most_intensity <= 1.0f) {
            scan.least_intensity = 0.0f;
            scan.most_intensity = 1.0f;
        }
        const double reach = std::max(length(scan.least), length(scan.most));
        scan.doubles = !(reach <= kFloatReach);
        scan.section = at;
        at += kE57SectionHeadBytes + scan.content_bytes();
    }
    return scans;
}

}  // namespace glowworm
