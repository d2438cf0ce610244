// Points of a bumpy, winding tunnel, evenly along it and round it, with its true normals: the same
// cave at any density. Writes OUT.ply, which `glowworm build` takes, and a scene, OUT.json.
//   winding_tunnel MILLIONS METRES OUT

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <numbers>
#include <random>

#include "octree/vec3.h"

namespace glowworm {
namespace {

Vec3d wall_at(double along, double angle) {
    const double radius = 1.8 + 0.5 * std::sin(along / 3) + 0.25 * std::sin(5 * angle + along) +
                          0.05 * std::sin(12 * along) * std::sin(9 * angle) +
                          0.012 * std::sin(40 * along + 3 * std::sin(angle)) * std::sin(23 * angle);
    return {3 * std::sin(along / 9) + radius * std::cos(angle), along,
            1.5 * std::sin(along / 17) + radius * std::sin(angle)};
}

void write(std::size_t count, double metres, const std::string& out) {
    std::ofstream file(out + ".ply", std::ios::binary);
    file << fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", count);
    for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
        file << fmt::format("property float {}\n", name);
    for (const char* name : {"red", "green", "blue"})
        file << fmt::format("property uchar {}\n", name);
    file << "end_header\n";

    constexpr double kStep = 1e-4;
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    for (std::size_t i = 0; i < count; ++i) {
        const double along = unit(random) * metres, angle = unit(random) * 2 * std::numbers::pi;
        const Vec3d at = wall_at(along, angle);
        const Vec3d inward = normalized(
            cross(wall_at(along, angle + kStep) - at, wall_at(along + kStep, angle) - at));
        const double grey = 150 + 60 * std::sin(2 * along) * std::sin(6 * angle) +
                            30 * std::sin(31 * along + 7 * angle);
        const float floats[6] = {static_cast<float>(at.x),     static_cast<float>(at.y),
                                 static_cast<float>(at.z),     static_cast<float>(inward.x),
                                 static_cast<float>(inward.y), static_cast<float>(inward.z)};
        const unsigned char colour[3] = {static_cast<unsigned char>(grey),
                                         static_cast<unsigned char>(0.9 * grey),
                                         static_cast<unsigned char>(0.8 * grey)};
        char point[sizeof floats + sizeof colour];
        std::memcpy(point, floats, sizeof floats);
        std::memcpy(point + sizeof floats, colour, sizeof colour);
        file.write(point, sizeof point);
    }
    std::ofstream(out + ".json") << R"({"lights":[
{"type":"point","name":"near","position":[1.0,4.0,0.5],"radiant_intensity":[10,10,10]},
{"type":"point","name":"far","position":[2.6,14.0,0.5],"radiant_intensity":[10,10,10]}],
"cameras":[{"name":"cam","position":[0.2,1.0,0.1],"look_at":[1.8,6.0,0.5],"up":[0,0,1],
"vfov_deg":65,"width":800,"height":600}]})"
                                 << "\n";
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    if (argc != 4) {
        fmt::print(stderr, "usage: winding_tunnel MILLIONS METRES OUT\n");
        return 2;
    }
    glowworm::write(static_cast<std::size_t>(std::atof(argv[1]) * 1e6), std::atof(argv[2]),
                    argv[3]);
}
