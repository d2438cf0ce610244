// Shadows of lamps without extent from cube maps drawn from the surfels beside shadows traced in
// the octree: how near each comes to known direct light at probes (mean error; how many are more
// than a tenth off, lit though dark and dark though lit), and processor milliseconds: to draw the
// maps, and to look from as many points of the walls as 800x600 pixels. Where OpenGL runs on the
// CPU.
//   bench_shadows CAVE.svo SCENE.json PROBES.csv

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>

#include "octree/error.h"
#include "shadow_maps.h"
#include "viewer/app/probes.h"
#include "viewer/gpu/glsl.h"
#include "viewer/gpu/vec4.h"
#include "viewer/light/direct.h"
#include "viewer/light/direct_field.h"

namespace glowworm {
namespace gpu {
namespace {

/// For share_of_lamp() and where lobes lie.
struct LampPass {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    std::span<const Light> lights;
    LightGrid grid;
#include "shaders/direct_light.glsl"
};

}  // namespace
}  // namespace gpu

namespace {

constexpr double kDarkShare = 0.02;           // of the mean truth: less is dark
constexpr double kOffShare = 0.1;             // relative error of a probe that counts as off
constexpr double kPoints = 800 * 600;         // that times are scaled to
constexpr double kBiases[] = {0.5, 1, 2, 4};  // texels
constexpr int kSizes[] = {512, 1024, 2048};

double processor_ms() {
    return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// As measure_direct_light() takes and gives them: of each place its position and its normal.
std::vector<gpu::vec4> measure_by_maps(gpu::LampPass& pass, std::span<const CubeMap> maps,
                                       const Vec3d& origin, double texels,
                                       std::span<const gpu::vec4> places) {
    const double offset = static_cast<double>(gpu::LampPass::kPointOffset) *
                          static_cast<double>(pass.grid.voxel_size);
    std::vector<gpu::vec4> measured(places.size(), gpu::vec4(0.0f));
    for (std::size_t i = 0; i < places.size(); i += 2) {
        const gpu::vec3 position(places[i]), normal(places[i + 1]);
        for (std::size_t l = 0; l < maps.size(); ++l) {
            const float share = pass.share_of_lamp(pass.lights[l], position, normal);
            if (share <= 0.0f) continue;
            const double seen =
                maps[l].visibility(origin + vec3_cast<double>(to_vec3(places[i])),
                                   vec3_cast<double>(to_vec3(places[i + 1])), texels, offset);
            measured[i] += pass.lights[l].intensity * (share * static_cast<float>(seen));
        }
    }
    return measured;
}

void print_row(const std::string& title, const ProbeTable& table,
               std::span<const gpu::vec4> measured, double make_ms, double look_ms) {
    std::vector<Irradiance> ours;
    double mean = 0;
    for (std::size_t i = 0; i < table.probes.size(); ++i) {
        ours.push_back({to_vec3(measured[2 * i]), {}});
        mean += static_cast<double>(table.truth[i].direct.y);
    }
    mean /= static_cast<double>(ours.size());
    int off = 0, lit = 0, dark = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
        const auto e = static_cast<double>(ours[i].direct.y);
        const auto truth = static_cast<double>(table.truth[i].direct.y);
        off += std::abs(e - truth) > kOffShare * std::max(truth, kDarkShare * mean) ? 1 : 0;
        lit += truth <= 0 && e > kDarkShare * mean ? 1 : 0;
        dark += truth > kDarkShare * mean && e <= 0 ? 1 : 0;
    }
    fmt::print("{:24} {:10.2f} {:6} {:6} {:6} {:10.0f} {:10.0f}\n", title,
               1e2 * compare_probes(table, ours)->direct.mean, off, lit, dark, make_ms, look_ms);
}

void run(const char* cave, const char* scene_file, const char* probes_file) {
    const OctreeFile file = OctreeFile::open(cave);
    const OctreeView& octree = file.view();
    const Scene scene = read_scene(scene_file);
    const ProbeTable table = read_probes(probes_file);
    if (table.truth.empty() || !scene.area_lights.empty()) {
        throw Error(ExitCode::kUsage, fmt::format("'{}' has no truth or '{}' has area lights: give "
                                                  "probes with E_direct_r and so on, of lamps",
                                                  probes_file, scene_file));
    }
    const Context context = Context::headless();
    const LightSettings settings;
    DirectField direct(context, octree, settings, make_light_ground(octree, settings.trace, true));
    direct.set_lights(lights_for_gpu(scene, octree, false));
    gpu::LampPass pass{
        {}, direct.octree().lobes.map<const Lobe>(), direct.lights(), direct.octree().grid};
    const DirectLightInput input{*direct.tracer(), pass.lobes, pass.lights, pass.grid};

    std::vector<gpu::vec4> probes, walls;  // the walls: where a frame's pixels may lie
    for (const MeterPoint& probe : table.probes) {
        const Vec3f at = vec3_cast<float>(probe.position - octree.grid.origin);
        probes.push_back({at.x, at.y, at.z, 0.0f});
        probes.push_back({probe.normal.x, probe.normal.y, probe.normal.z, 0.0f});
    }
    for (std::uint32_t i = 0; i < pass.lobes.size(); ++i) {
        walls.push_back(gpu::vec4(pass.lobe_position(i), 0.0f));
        walls.push_back(gpu::vec4(pass.lobe_normal(i), 0.0f));
    }
    const auto ms_of_frame = [&](const auto& measure) {
        const double begun = processor_ms();
        measure(walls);
        return (processor_ms() - begun) * kPoints / static_cast<double>(walls.size() / 2);
    };
    const auto traced = [&](const std::vector<gpu::vec4>& places) {
        std::vector<gpu::vec4> measured(places.size());
        measure_direct_light(input, places, measured);
        return measured;
    };
    fmt::print("{} points, {} lamps, {} probes, {} lobes\n", octree.surfels.size(),
               pass.lights.size(), table.probes.size(), pass.lobes.size());
    fmt::print("{:24} {:>10} {:>6} {:>6} {:>6} {:>10} {:>10}\n", "shadows", "error %", "off", "lit",
               "dark", "make, ms", "look, ms");
    print_row("traced", table, traced(probes), 0, ms_of_frame(traced));

    Frame frame(context, octree);
    const auto draw_all = [&](int size) {
        std::vector<CubeMap> maps;
        for (const gpu::Light& light : pass.lights) {
            const Vec3d lamp = octree.grid.origin + vec3_cast<double>(to_vec3(light.position));
            maps.push_back(draw_cube(frame, lamp, size));
        }
        return maps;
    };
    draw_all(kSizes[0]);  // brings points from the file
    for (const int size : kSizes) {
        const double begun = processor_ms();
        const std::vector<CubeMap> maps = draw_all(size);
        const double make_ms = processor_ms() - begun;
        for (const double texels : kBiases) {
            const auto mapped = [&](const std::vector<gpu::vec4>& places) {
                return measure_by_maps(pass, maps, octree.grid.origin, texels, places);
            };
            print_row(fmt::format("{} texels, moved by {}", size, texels), table, mapped(probes),
                      make_ms, ms_of_frame(mapped));
        }
    }
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    if (argc != 4) {
        fmt::print(stderr, "usage: bench_shadows CAVE.svo SCENE.json PROBES.csv\n");
        return 2;
    }
    try {
        glowworm::run(argv[1], argv[2], argv[3]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
