#include "light_speed.h"

#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <vector>

#include "viewer/app/cave.h"
#include "viewer/light/light_field.h"

namespace glowworm {
namespace {

double seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
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
    const Cave cave = open_cave(file, depth);
    const Scene scene = read_scene(scene_file);
    const OctreeView octree = cave.light();
    const auto lobes = static_cast<double>(octree.lobes.size());
    fmt::print("\n{}: light at depth {}, {} lobes; a copy moves {:.1f} GB/s\n", file,
               octree.grid.depth, octree.lobes.size(), memory_bandwidth());
    fmt::print("{:8} {:>10} {:>10} {:>11} {:>8} {:>14} {:>9} {:>12}\n", "method", "inject ms",
               "prepare ms", "ms / bounce", "bounces", "settled in ms", "lamp ms", "B/lobe, GB/s");
    for (const LightMethod& method : methods) {
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

}  // namespace glowworm
