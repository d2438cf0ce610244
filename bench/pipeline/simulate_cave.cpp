// Simulated scans of a winding row of chambers and passages, to measure whole conversions on.
// usage: simulate_cave FOLDER [STATIONS] [POINTS]
// Writes scan000.ply … in each station's own frame, and true_poses.json.
#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/poses.h"
#include "preprocess/write/cloud_writer.h"
#include "register/simulated_cave.h"

using namespace glowworm;
using namespace glowworm::testing;

namespace {

constexpr double kStep = 4.0;          // m between stations
constexpr double kChamberStep = 12.0;  // m between chambers
constexpr double kSight = 25.0;        // m: farther spheres are not asked

/// The middle of chamber `k`, left and right of a line by turns.
Eigen::Vector3d chamber(int k) {
    return {kChamberStep * k, k % 2 == 0 ? -2.0 : 2.0, 0.4 * (k % 3)};
}

struct Site {
    SimulatedCave cave;
    std::vector<Eigen::Vector3d> stations;
};

Site make_site(int stations) {
    Site site;
    const int steps = static_cast<int>(kChamberStep / kStep);
    for (int i = 0; i < stations; ++i) {
        const int k = i / steps;
        const double along = double(i % steps) / steps;
        if (i % steps == 0) {
            add_chamber(site.cave, chamber(k), static_cast<unsigned>(2 * k + 1));
            if (k > 0)
                add_passage(site.cave, chamber(k - 1), chamber(k), static_cast<unsigned>(2 * k));
        }
        site.stations.push_back(chamber(k) + along * (chamber(k + 1) - chamber(k)));
        site.cave.air.push_back({site.stations.back(), 1.2});
    }
    return site;
}

SimulatedCave near(const SimulatedCave& cave, const Eigen::Vector3d& place) {
    SimulatedCave part;
    for (const Sphere& sphere : cave.air)
        if ((sphere.centre - place).norm() < kSight + sphere.radius) part.air.push_back(sphere);
    return part;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argv[1][0] == '-') {
        fmt::print(stderr, "usage: simulate_cave FOLDER [STATIONS] [POINTS]\n");
        return 2;
    }
    const std::filesystem::path folder = argv[1];
    const int stations = argc > 2 ? std::atoi(argv[2]) : 60;
    const std::size_t points = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 100'000;
    std::filesystem::create_directories(folder);
    const Site site = make_site(stations);
    Poses poses;
    poses.scans.resize(site.stations.size());
    tbb::parallel_for(std::size_t{0}, site.stations.size(), [&](std::size_t i) {
        const Eigen::Vector3d& place = site.stations[i];
        const auto seed = static_cast<unsigned>(i);
        const Eigen::Isometry3d T = station_at(place, seed);
        PointCloud cloud;
        cloud.points = scan_cave(near(site.cave, place), T, points, seed).points;
        const std::string name = fmt::format("scan{:03}.ply", i);
        write_cloud(cloud, folder / name);
        poses.scans[i] = {.file = name, .T_world_scan = T, .status = PoseStatus::kReference};
    });
    write_poses(poses, folder / "true_poses.json");
}
