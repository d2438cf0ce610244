#include "gi_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "octree/area_lights.h"
#include "octree/pack.h"

namespace glowworm::testing {

namespace {

constexpr double kLeastTruth = 0.02;  // of the scene's mean

/// x y z nx ny nz float, red green blue uchar, in two scenes emission_r/g/b float.
std::vector<Surfel> read_points(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::size_t count = 0;
    bool emits = false;
    for (std::string line; std::getline(file, line) && line != "end_header";) {
        if (line.starts_with("element vertex ")) count = std::stoul(line.substr(15));
        emits |= line == "property float emission_r";
    }
    std::vector<Surfel> surfels(count);
    for (Surfel& surfel : surfels) {
        std::array<float, 6> place{};
        std::array<unsigned char, 3> colour{};
        std::array<float, 3> emission{};
        file.read(reinterpret_cast<char*>(place.data()), sizeof place);
        file.read(reinterpret_cast<char*>(colour.data()), sizeof colour);
        if (emits) file.read(reinterpret_cast<char*>(emission.data()), sizeof emission);
        surfel.position = {place[0], place[1], place[2]};
        surfel.normal = {place[3], place[4], place[5]};
        surfel.albedo = {unpack_srgb8(colour[0]), unpack_srgb8(colour[1]), unpack_srgb8(colour[2])};
        surfel.emission = {emission[0], emission[1], emission[2]};
    }
    if (!file) throw std::runtime_error(path.string() + " is short");
    return surfels;
}

std::vector<GiScene::Truth> read_truth(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<GiScene::Truth> probes;
    std::string line;
    std::getline(file, line);  // names
    while (std::getline(file, line)) {
        std::ranges::replace(line, ',', ' ');
        std::istringstream numbers(line);
        std::array<double, 12> v{};
        for (double& number : v)
            numbers >> number;
        probes.push_back({{v[0], v[1], v[2]},
                          vec3_cast<float>(Vec3d{v[3], v[4], v[5]}),
                          {v[6], v[7], v[8]},
                          {v[9], v[10], v[11]}});
    }
    return probes;
}

}  // namespace

GiScene read_gi_scene(const std::filesystem::path& folder) {
    GiScene gi;
    gi.scene = read_scene(folder / "scene.json");
    gi.cloud.surfels = read_points(folder / "points.ply");
    add_area_lights(gi.cloud, gi.scene.area_lights);
    gi.probes = read_truth(folder / "probes.csv");
    return gi;
}

double mean_relative_error(const std::vector<Vec3d>& measured, const std::vector<Vec3d>& truth) {
    double scale = 0.0, sum = 0.0;
    const double values = 3.0 * static_cast<double>(truth.size());
    for (const Vec3d& t : truth)
        scale += (t.x + t.y + t.z) / values;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            sum +=
                std::abs(measured[i][c] - truth[i][c]) / std::max(truth[i][c], kLeastTruth * scale);
        }
    }
    return sum / values;
}

}  // namespace glowworm::testing
