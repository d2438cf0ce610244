// Milliseconds of each pass, medians: our frame beside one drawn and gathered as the 2016 paper
// does, in the same run. The paper's is given without shading, so the ratio is the least it can be.
//   bench_frame CAVE.svo [SCENE.json [CAMERA [FRAMES]]]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <exception>

#include "bench/frame_sprites.h"
#include "viewer/app/start.h"
#include "viewer/frame/display.h"
#include "viewer/frame/frame.h"

namespace glowworm {
namespace {

constexpr float kSpriteScale = 2.0f;  // spheres that leave few gaps; our discs have 3

double median_ms(std::vector<PassTimer::Sample> samples) {
    std::ranges::sort(samples, {}, &PassTimer::Sample::gpu_ms);
    return samples[samples.size() / 2].gpu_ms;
}

double print(const char* title, const PassTimer& timer) {
    double total = 0;
    for (const auto& [pass, samples] : timer.samples()) {
        fmt::print("  {:9} {:14} {:10.1f} ms\n", title, pass, median_ms(samples));
        total += median_ms(samples);
    }
    fmt::print("  {:9} {:14} {:10.1f} ms\n", title, "all", total);
    return total;
}

void run(const std::string& cave, const std::string& scene_file, const std::string& name,
         int frames) {
    const OctreeFile file = OctreeFile::open(cave);
    const OctreeView& octree = file.view();
    Start start = start_of(octree, scene_file, name);
    const Context context = Context::headless();
    LightField links(context, octree, start.scene);
    LightField cones(context, octree, start.scene, {.gather = Gather::kCones, .faithful = true});
    links.iterate(2);
    cones.iterate(1);
    Frame frame(context, octree);
    frame.set_panels(start.scene.area_lights);
    Display display;

    fmt::print("{}: {} points, {} lobes\n", context.device().renderer, octree.surfels.size(),
               octree.lobes.size());
    for (const auto& [width, height] : {std::pair{800, 600}, {1600, 900}}) {
        start.camera.width = width;
        start.camera.height = height;
        const View view = view_of(start.camera);
        const Texture shown("shown", GL_RGBA8, width, height);
        Sprites sprites(octree, width, height);
        frame.draw(view, links, Frame::Missing::kWaitFor);
        PassTimer ours(context.device()), paper(context.device());
        for (int i = 0; i < frames; ++i) {
            ours.measure("bounce", [&] { links.iterate(1, false); });
            frame.draw(view, links, Frame::Missing::kAskFor, &ours);
            ours.measure("tone map",
                         [&] { display.draw(frame.beauty(), shown, 0.0, ToneCurve::kAgx); });
            paper.measure("filter, gather", [&] { cones.iterate(1, false); });
            paper.measure("sprites", [&] { sprites.draw(octree, frame.gbuffer(), kSpriteScale); });
        }
        fmt::print("{}x{}, {} points drawn, {} hidden\n", width, height, frame.surfels_drawn(),
                   frame.surfels_hidden());
        const double our_ms = print("ours", ours), paper_ms = print("paper", paper);
        fmt::print("  the paper's takes {:.2f} times ours\n", paper_ms / our_ms);
    }
    for (const std::string& error : context.errors())
        fmt::print("OpenGL: {}\n", error);
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: bench_frame CAVE.svo [SCENE.json [CAMERA [FRAMES]]]\n");
        return 2;
    }
    try {
        glowworm::run(argv[1], argc > 2 ? argv[2] : "", argc > 3 ? argv[3] : "",
                      argc > 4 ? std::atoi(argv[4]) : 3);
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
