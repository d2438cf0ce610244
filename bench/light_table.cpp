// Cones, the 2016 paper's cones and links side by side: how near each comes to what is known of
// simple caves, and with a file the time that tracing, a bounce and settling take.
//   bench_light sphere|density|cube|wall|tunnel [DEPTH]
//   bench_light speed DEPTH CAVE.svo SCENE.json [METHOD...]

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <span>
#include <string_view>
#include <vector>

#include "light_speed.h"
#include "tests/viewer/light_accuracy.h"

namespace glowworm {
namespace {

using namespace testing;

constexpr std::array<LightMethod, 3> kMethods = {{
    {"links", {}},
    {"6 cones", {.gather = Gather::kCones}},
    {"faithful", {.gather = Gather::kCones, .faithful = true}},
}};

constexpr std::size_t kPhotons = 20'000'000;  // for truth

double percent(double share) {
    return 100.0 * share;
}

void sphere_table(const Context& context, std::uint32_t depth) {
    fmt::print("{:8} {:>6} {:>6} {:>9} {:>9} {:>9} {:>8}\n", "method", "albedo", "lamp m", "mean %",
               "rms %", "worst %", "bounces");
    const auto row = [&](const LightMethod& method, float albedo, double off_centre) {
        const SphereAccuracy a =
            sphere_accuracy(context, method.settings, depth, albedo, off_centre);
        fmt::print("{:8} {:6.1f} {:6.1f} {:9.3f} {:9.3f} {:9.2f} {:8}\n", method.name, albedo,
                   off_centre, percent(a.mean), percent(a.rms), percent(a.worst), a.bounces);
    };
    for (const float albedo : {0.2f, 0.5f, 0.8f}) {
        for (const double off_centre : {0.0, 1.2}) {
            for (const LightMethod& method : kMethods)
                row(method, albedo, off_centre);
        }
    }
    row({"256", {.links = 256}}, 0.8f, 1.2);
}

void density_table(const Context& context, std::uint32_t depth) {
    fmt::print("{:8} {:>12} {:>9} {:>9}\n", "method", "points/face", "mean %", "rms %");
    for (const double points_per_face : {0.5, 1.0, 2.0, 4.0}) {
        for (const LightMethod& method : kMethods) {
            const SphereAccuracy a =
                sphere_accuracy(context, method.settings, depth, 0.8f, 1.2, points_per_face);
            fmt::print("{:8} {:12.1f} {:9.3f} {:9.3f}\n", method.name, points_per_face,
                       percent(a.mean), percent(a.rms));
        }
    }
}

void cube_table(const Context& context, std::uint32_t depth) {
    fmt::print("{:8} {:>6} {:>8} {:>8} {:>9}   settled: emitter and walls, %\n", "method", "albedo",
               "bias %", "nrms %", "emitter %");
    for (const double albedo : {0.5, 0.8}) {
        const KnownLight cube = known_cube(albedo, kPhotons);
        const auto row = [&](const LightMethod& method) {
            const CubeAccuracy a = cube_accuracy(context, method.settings, depth, cube);
            fmt::print("{:8} {:6.1f} {:8.2f} {:8.2f} {:9.2f}  ", method.name, albedo,
                       percent(a.bias), percent(a.nrms), percent(a.emitter));
            for (const double wall : a.walls)
                fmt::print(" {:7.2f}", percent(wall));
            fmt::print("\n");
        };
        for (const LightMethod& method : kMethods)
            row(method);
        row({"1024", {.links = 1024}});
    }
}

void wall_table(const Context& context, std::uint32_t depth) {
    fmt::print("{:8} {:>12} {:>14} {:>14}\n", "method", "wall, leaves", "leak, lobes %", "meter %");
    for (const double voxels : {0.5, 1.0, 2.0, 4.0}) {
        for (const LightMethod& method : kMethods) {
            const WallLeak leak = wall_leak(context, method.settings, depth, voxels);
            fmt::print("{:8} {:12.1f} {:14.4f} {:14.4f}\n", method.name, voxels,
                       percent(leak.lobes), percent(leak.meter));
        }
    }
}

void tunnel_table(const Context& context, std::uint32_t depth) {
    fmt::print("{:8} {:>6}   settled: sections, the lit one first, %\n", "method", "albedo");
    for (const double albedo : {0.8, 0.5}) {
        const KnownLight tunnel = known_tunnel(albedo, kPhotons);
        for (const LightMethod& method : kMethods) {
            fmt::print("{:8} {:6.1f}", method.name, albedo);
            for (const double error : tunnel_accuracy(context, method.settings, depth, tunnel))
                fmt::print(" {:7.2f}", percent(error));
            fmt::print("\n");
        }
        fmt::print("links to 1 % at the far end: {} bounces\n",
                   bounces_to_far_end(context, {}, depth, tunnel));
    }
}

int run(int argc, char** argv) {
    const std::string_view what = argc > 1 ? argv[1] : "sphere";
    const auto depth = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 6);
    const Context context = Context::headless();
    if (what == "speed" && argc >= 5) {
        std::vector<LightMethod> methods(kMethods.begin(), kMethods.end());
        if (argc > 5) {
            std::erase_if(methods, [&](const LightMethod& method) {
                return std::ranges::none_of(
                    std::span(argv + 5, argv + argc),
                    [&](const char* name) { return method.name == std::string_view(name); });
            });
        }
        speed_table(context, methods, argv[3], argv[4], depth);
        return 0;
    }
    constexpr struct {
        std::string_view name;
        void (*print)(const Context&, std::uint32_t);
    } kTables[] = {{"sphere", sphere_table},
                   {"density", density_table},
                   {"cube", cube_table},
                   {"wall", wall_table},
                   {"tunnel", tunnel_table}};
    for (const auto& table : kTables) {
        if (table.name != what) continue;
        table.print(context, depth);
        return 0;
    }
    fmt::print(stderr,
               "bench_light sphere|density|cube|wall|tunnel [DEPTH]\n"
               "bench_light speed DEPTH CAVE.svo SCENE.json [METHOD...]\n");
    return 2;
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    try {
        return glowworm::run(argc, argv);
    } catch (const std::exception& error) {
        fmt::print(stderr, "bench_light: {}\n", error.what());
        return 1;
    }
}
