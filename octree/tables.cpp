#include "octree/tables.h"

#include <algorithm>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr std::size_t kMostOfEach = 65535;

std::string name_at(std::string_view names, std::uint32_t offset, std::uint32_t bytes) {
    if (offset > names.size() || bytes > names.size() - offset) return "";
    return std::string(names.substr(offset, bytes));
}

}  // namespace

void write_tables(std::span<const Station> stations, std::span<const AreaLight> lights,
                  Octree& octree) {
    if (stations.size() > kMostOfEach || lights.size() > kMostOfEach) {
        throw Error(
            ExitCode::kUsage,
            "an octree holds at most 65535 stations and 65535 area lights; merge some scans");
    }
    octree.stations.clear();
    octree.area_lights.clear();
    octree.names.clear();
    const auto add_name = [&](const std::string& name, auto& record) {
        record.name_offset = static_cast<std::uint32_t>(octree.names.size());
        record.name_bytes = static_cast<std::uint32_t>(name.size());
        octree.names += name;
    };
    for (const Station& station : stations) {
        StationRecord record{};
        for (int axis = 0; axis < 3; ++axis)
            record.position[axis] = station.position[axis];
        std::copy(std::begin(station.rotation), std::end(station.rotation), record.rotation);
        record.has_viewpoint = station.has_viewpoint ? 1 : 0;
        add_name(station.name, record);
        octree.stations.push_back(record);
    }
    for (const AreaLight& light : lights) {
        AreaLightRecord record{};
        for (int corner = 0; corner < 4; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
                record.corners[corner * 3 + axis] = light.corners[corner][axis];
            }
        }
        for (int channel = 0; channel < 3; ++channel) {
            record.radiance[channel] = light.radiance[channel];
        }
        add_name(light.name, record);
        octree.area_lights.push_back(record);
    }
}

std::vector<Station> read_stations(const OctreeView& octree) {
    std::vector<Station> stations;
    for (const StationRecord& record : octree.stations) {
        Station station;
        station.position = {record.position[0], record.position[1], record.position[2]};
        std::copy(std::begin(record.rotation), std::end(record.rotation), station.rotation);
        station.has_viewpoint = record.has_viewpoint != 0;
        station.name = name_at(octree.names, record.name_offset, record.name_bytes);
        stations.push_back(std::move(station));
    }
    return stations;
}

std::vector<AreaLight> read_area_lights(const OctreeView& octree) {
    std::vector<AreaLight> lights;
    for (const AreaLightRecord& record : octree.area_lights) {
        AreaLight light;
        for (int corner = 0; corner < 4; ++corner) {
            for (int axis = 0; axis < 3; ++axis) {
                light.corners[corner][axis] = record.corners[corner * 3 + axis];
            }
        }
        light.radiance = {record.radiance[0], record.radiance[1], record.radiance[2]};
        light.name = name_at(octree.names, record.name_offset, record.name_bytes);
        lights.push_back(std::move(light));
    }
    return lights;
}

}  // namespace glowworm
