// Milliseconds of the passes that draw surfaces, medians, by compiled code and by shaders where
// OpenGL runs on the CPU, and how far apart the two are.
//   bench_surfaces CAVE.svo [SCENE.json [CAMERA [FRAMES [shaders]]]]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <exception>

#include "viewer/app/start.h"
#include "viewer/frame/frame.h"

namespace glowworm {
namespace {

double median_ms(std::vector<PassTimer::Sample> samples) {
    std::ranges::sort(samples, {}, &PassTimer::Sample::gpu_ms);
    return samples[samples.size() / 2].gpu_ms;
}

void print(const char* title, const PassTimer& timer) {
    double total = 0;
    for (const auto& [pass, samples] : timer.samples()) {
        fmt::print("  {:9} {:14} {:10.2f} ms\n", title, pass, median_ms(samples));
        total += median_ms(samples);
    }
    fmt::print("  {:9} {:14} {:10.2f} ms\n", title, "all", total);
}

void compare(const std::vector<gpu::vec4>& a, const std::vector<gpu::vec4>& b) {
    std::size_t hits = 0, one_only = 0, apart = 0;
    double worst = 0, normals = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if ((a[i].w > 0) != (b[i].w > 0)) ++one_only;
        if (a[i].w <= 0 || b[i].w <= 0) continue;
        ++hits;
        const double off = std::abs(double{a[i].w} / double{b[i].w} - 1.0);
        const gpu::vec4 turn = a[i] - b[i];
        if (off > 1e-4) ++apart;
        worst = std::max(worst, off);
        normals += std::abs(turn.x) + std::abs(turn.y) + std::abs(turn.z);
    }
    fmt::print(
        "  compiled and shaders: {} pixels, {} seen by one alone, {} more than 1e-4 apart in "
        "depth, "
        "worst {:.2g}; normals {:.2g} in the mean\n",
        hits, one_only, apart, worst,
        normals / static_cast<double>(std::max<std::size_t>(hits, 1)));
}

void run(const std::string& cave, const std::string& scene_file, const std::string& name,
         int frames, bool shaders_too) {
    const OctreeFile file = OctreeFile::open(cave);
    const OctreeView& octree = file.view();
    Start start = start_of(octree, scene_file, name);
    const Context context = Context::headless();
    Frame frame(context, octree);
    fmt::print("{}: {} points, {} chunks\n", context.device().renderer, octree.surfels.size(),
               octree.chunks.size());
    for (const auto& [width, height] : {std::pair{800, 600}, {1600, 900}}) {
        start.camera.width = width;
        start.camera.height = height;
        const View view = view_of(start.camera);
        const auto pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
        std::vector<std::vector<gpu::vec4>> surfaces;
        for (const bool shaders : {false, true}) {
            if (shaders && !shaders_too) continue;
            frame.force_shaders(shaders);
            frame.draw_surfaces(view, Frame::Missing::kWaitFor);
            PassTimer timer(context.device());
            const std::clock_t begun = std::clock();
            const int times = shaders ? 1 : frames;
            for (int i = 0; i < times; ++i)
                frame.draw_surfaces(view, Frame::Missing::kAskFor, &timer);
            const double cpu_ms =
                1e3 * static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC / times;
            if (!shaders) {
                fmt::print("{}x{}, {} points drawn, {} hidden\n", width, height,
                           frame.surfels_drawn(), frame.surfels_hidden());
            }
            print(shaders ? "shaders" : "compiled", timer);
            fmt::print("  {:.2f} ms of processors a frame\n", cpu_ms);
            surfaces.push_back(frame.gbuffer().surfaces().read<gpu::vec4>(pixels));
        }
        if (shaders_too) compare(surfaces[0], surfaces[1]);
    }
    for (const std::string& error : context.errors())
        fmt::print("OpenGL: {}\n", error);
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr,
                   "usage: bench_surfaces CAVE.svo [SCENE.json [CAMERA [FRAMES [shaders]]]]\n");
        return 2;
    }
    try {
        glowworm::run(argv[1], argc > 2 ? argv[2] : "", argc > 3 ? argv[3] : "",
                      argc > 4 ? std::atoi(argv[4]) : 5, argc > 5);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
