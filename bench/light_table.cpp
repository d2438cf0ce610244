// Cones, the 2016 paper's cones and links side by side: error against the formula for a closed
// sphere, and with a file the time that tracing, a bounce and settling take.
//   bench_light [DEPTH [CAVE.svo SCENE.json]]

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <numbers>
#include <vector>

#include "octree/build.h"
#include "viewer/app/cave.h"
#include "viewer/gpu/context.h"
#include "viewer/light/light_field.h"

namespace glowworm {
namespace {

constexpr double kIntensity = 10.0;  // W/sr
constexpr double kRadius = 2.0;      // m

struct Method {
    const char* name;
    LightSettings settings;
};

const std::array<Method, 3>& methods() {
    static const std::array<Method, 3> all = {{
        {"links", {}},
        {"6 cones", {.gather = Gather::kCones}},
        {"faithful", {.gather = Gather::kCones, .faithful = true}},
    }};
    return all;
}

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// The inside of a sphere, evenly covered (a Fibonacci lattice).
SurfelCloud sphere(int count, float albedo) {
    SurfelCloud cloud;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < count; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / count;
        const double r = std::sqrt(1.0 - z * z);
        const Vec3d n{r * std::cos(golden * i), r * std::sin(golden * i), z};
        Surfel& surfel = cloud.surfels.emplace_back();
        surfel.position = vec3_cast<float>(n * kRadius);
        surfel.normal = vec3_cast<float>(-n);
        surfel.radius = static_cast<float>(2.0 * kRadius / std::sqrt(count));
        surfel.albedo = {albedo, albedo, albedo};
    }
    return cloud;
}

/// E_indirect = flux / (4 pi R^2) rho / (1 - rho) everywhere, wherever the lamp stands.
void sphere_table(const Context& context, std::uint32_t depth) {
    fmt::print("{:8} {:>6} {:>6} {:>9} {:>9} {:>9} {:>8}\n", "method", "albedo", "lamp m", "mean %",
               "rms %", "worst %", "bounces");
    for (const float albedo : {0.2f, 0.5f, 0.8f}) {
        BuildSettings build;
        build.depth = depth;
        const Octree octree = build_octree(sphere(10 << (2 * depth), albedo), build);
        const double rho = static_cast<double>(albedo);
        const double truth = kIntensity / (kRadius * kRadius) * rho / (1.0 - rho);
        for (const double off_centre : {0.0, 0.6 * kRadius}) {
            Scene scene;
            const auto power = static_cast<float>(kIntensity);
            scene.point_lights.push_back({"lamp", {off_centre, 0.0, 0.0}, {power, power, power}});
            for (const Method& method : methods()) {
                LightField field(context, octree.view(), scene, method.settings);
                const Convergence convergence = field.converge();
                double mean = 0.0, squares = 0.0, worst = 0.0;
                const auto indirect = field.read_indirect();
                for (const gpu::vec4& e : indirect) {
                    const double error = 100.0 * (static_cast<double>(e.x) / truth - 1.0);
                    mean += error / static_cast<double>(indirect.size());
                    squares += error * error / static_cast<double>(indirect.size());
                    worst = std::max(worst, std::abs(error));
                }
                fmt::print("{:8} {:6.1f} {:6.1f} {:9.3f} {:9.3f} {:9.2f} {:8}\n", method.name,
                           albedo, off_centre, mean, std::sqrt(squares), worst,
                           convergence.bounces);
            }
        }
    }
}

/// GB/s of a copy that no cache holds, read and written bytes together.
double memory_bandwidth() {
    const std::vector<char> from(256 << 20, 1);
    std::vector<char> to(from.size());
    std::memcpy(to.data(), from.data(), from.size());
    const double start = seconds();
    std::memcpy(to.data(), from.data(), from.size());
    return 2e-9 * static_cast<double>(from.size()) / (seconds() - start);
}

void speed_table(const Context& context, const char* file, const char* scene_file,
                 std::uint32_t depth) {
    const Cave cave = open_cave(file, depth);
    const Scene scene = read_scene(scene_file);
    const OctreeView octree = cave.light();
    const auto lobes = static_cast<double>(octree.lobes.size());
    fmt::print("\n{}: light at depth {}, {} lobes; a copy moves {:.1f} GB/s\n", file,
               octree.grid.depth, octree.lobes.size(), memory_bandwidth());
    fmt::print("{:8} {:>10} {:>10} {:>11} {:>8} {:>14} {:>9} {:>12}\n", "method", "inject ms",
               "prepare ms", "ms / bounce", "bounces", "settled in ms", "lamp ms", "B/lobe, GB/s");
    for (const Method& method : methods()) {
        const double begin = seconds();
        LightField field(context, octree, scene, method.settings);
        field.read_direct();
        const double injected = seconds();
        field.prepare();
        const double prepared = seconds();
        const Convergence convergence = field.converge();
        field.read_indirect();
        const double settled = seconds();
        field.set_scene(scene);  // as a moved lamp is
        field.read_direct();
        const double moved = seconds();
        const double bounce = (settled - prepared) / convergence.bounces;
        // A link is read with the radiance at its end; radiance, x and T(x) are read and written.
        const double bytes = method.settings.gather == Gather::kLinks
                                 ? method.settings.links * (4.0 + 16.0) + 6 * 16.0
                                 : 0.0;
        fmt::print("{:8} {:10.0f} {:10.0f} {:11.1f} {:8} {:14.0f} {:9.0f} {:6.0f}, {:4.1f}\n",
                   method.name, 1e3 * (injected - begin), 1e3 * (prepared - injected), 1e3 * bounce,
                   convergence.bounces, 1e3 * (settled - prepared), 1e3 * (moved - settled), bytes,
                   1e-9 * bytes * lobes / bounce);
    }
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    try {
        const auto depth = static_cast<std::uint32_t>(argc > 1 ? std::atoi(argv[1]) : 5);
        const auto context = glowworm::Context::headless();
        if (argc > 3) {
            glowworm::speed_table(context, argv[2], argv[3], depth);
        } else {
            glowworm::sphere_table(context, depth);
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_light: {}\n", error.what());
        return 1;
    }
    return 0;
}
