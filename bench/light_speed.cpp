#include "light_speed.h"

#include <fmt/format.h>

#include <cstring>
#include <ctime>
#include <vector>

#include "viewer/app/cave.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"
#include "viewer/light/walls.h"

namespace glowworm {
namespace {

constexpr int kBounces = 4;

/// Of the processor, all threads together: what else runs on the machine does not count.
double seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
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

}  // namespace

void speed_table(const Context& context, std::span<const LightMethod> methods, const char* file,
                 const char* scene_file, std::uint32_t depth) {
    const Cave cave = open_cave(file, {.depth = depth});
    const Scene scene = read_scene(scene_file);
    OctreeView octree = cave.light();
    octree.links = {};  // baked ones: their trace is measured too
    octree.links_per_lobe = 0;
    const auto lobes = static_cast<double>(octree.lobes.size());
    const double before_walls = seconds();
    walls_beside(octree);
    const double walls = seconds() - before_walls;
    fmt::print(
        "\n{}: light at depth {}, {} lobes; the walls beside them take {:.0f} ms once; a copy "
        "moves {:.1f} GB/s\n",
        file, octree.grid.depth, octree.lobes.size(), 1e3 * walls, memory_bandwidth());
    fmt::print("{:8} {:>9} {:>10} {:>11} {:>9} {:>10} {:>8} {:>11}   {}\n", "method", "inject ms",
               "prepare ms", "bounce ms", "turn ms", "smooth ms", "bounces", "settled ms",
               "B/lobe, GB/s");
    for (const LightMethod& method : methods) {
        const double begin = seconds();
        LightField field(context, octree, scene, method.settings);
        field.read_direct();
        const double injected = seconds();
        field.prepare();
        const double prepared = seconds();
        const auto time = [&](int bounces, bool at_rest) {
            const double start = seconds();
            field.iterate(bounces, at_rest);
            measure_light(field, {});
            field.read_indirect();
            return seconds() - start;
        };
        time(1, true);  // compiles what is compiled late
        const double one = time(1, false);
        const double bounce = (time(1 + kBounces, false) - one) / kBounces;
        const double at_rest = time(1, true);
        field.forget_indirect();
        const double start = seconds();
        const Convergence convergence = field.converge();
        field.read_indirect();
        const double settled = seconds() - start;
        // A link is read with the radiance at its end; radiance, x and T(x) are read and written.
        const double bytes = method.settings.gather == Gather::kLinks
                                 ? method.settings.links * (4.0 + 16.0) + 6 * 16.0
                                 : 0.0;
        fmt::print(
            "{:8} {:9.0f} {:10.0f} {:11.1f} {:9.0f} {:10.0f} {:8} {:11.0f}   {:.0f}, {:.1f}\n",
            method.name, 1e3 * (injected - begin), 1e3 * (prepared - injected), 1e3 * bounce,
            1e3 * (one - bounce), 1e3 * (at_rest - one), convergence.bounces, 1e3 * settled, bytes,
            1e-9 * bytes * lobes / bounce);
    }
}

}  // namespace glowworm
