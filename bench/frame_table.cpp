// Milliseconds of our frame's passes beside those of one that is drawn, gathered and shaded as the
// 2016 paper does, in the same run; both make the whole picture, from points to tone-mapped pixels.
// While light rests only the camera moves: our light has settled along kept links and costs
// nothing, the paper's gathers every frame, which is its method. While it moves, so do all lamps,
// and each frame has direct light anew and one bounce on both sides.
//   bench_frame CAVE.svo [SCENE.json [CAMERA [FRAMES [PICTURES]]]]

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <exception>
#include <fstream>

#include "bench/frame_sprites.h"
#include "viewer/app/start.h"
#include "viewer/frame/display.h"
#include "viewer/frame/frame.h"
#include "viewer/frame/png.h"

namespace glowworm {
namespace {

constexpr float kSpriteScale = 2.0f;  // spheres that leave few gaps; our discs have 3
constexpr double kLampStep = 0.05;    // m a frame, to and fro
constexpr double kStep = 0.01;        // m the camera steps aside every other frame

double median(std::vector<double> values) {
    std::ranges::sort(values);
    return values[values.size() / 2];
}

/// What frames of one kind cost: wall time of each pass, and what all threads together work.
class Frames {
  public:
    Frames(const Context& context, std::string title)
        : timer_(context.device()), title_(std::move(title)) {}

    template <typename Draw>
    void time(const Draw& draw) {
        const std::clock_t begun = std::clock();
        draw(timer_);
        worked_ms_.push_back(1e3 * static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC);
    }

    struct Cost {
        double wall_ms = 0, processors_ms = 0;
    };
    Cost print() const {
        Cost cost{0, median(worked_ms_)};
        for (const auto& [pass, samples] : timer_.samples()) {
            std::vector<double> all;
            for (const PassTimer::Sample& sample : samples)
                all.push_back(sample.gpu_ms);
            fmt::print("  {:22} {:20} {:9.1f} ms\n", title_, pass, median(all));
            cost.wall_ms += median(all);
        }
        fmt::print("  {:22} {:20} {:9.1f} ms, {:.0f} ms of processors\n", title_, "all",
                   cost.wall_ms, cost.processors_ms);
        return cost;
    }

  private:
    PassTimer timer_;
    std::string title_;
    std::vector<double> worked_ms_;
};

void compare(const char* light, const Frames& ours, const Frames& paper) {
    const Frames::Cost a = ours.print(), b = paper.print();
    fmt::print("  {}: the paper's frame takes {:.2f} times ours, {:.2f} times its work\n", light,
               b.wall_ms / a.wall_ms, b.processors_ms / a.processors_ms);
}

Scene with_lamps_moved(Scene scene, int step) {
    const Vec3d by{kLampStep * (step % 2 == 0 ? 1 : -1), 0.0, 0.0};
    for (PointLight& light : scene.point_lights)
        light.position += by;
    for (SpotLight& light : scene.spot_lights)
        light.position += by;
    for (AreaLight& light : scene.area_lights)
        light.radiance = light.radiance * (step % 2 == 0 ? 1.1f : 0.9f);
    return scene;
}

void write_picture(const Texture& shown, const std::string& name) {
    const auto floats = shown.read_floats(GL_RGBA, 4);
    Picture picture{shown.width(), shown.height(), {}};
    for (std::size_t i = 0; i < floats.size(); ++i) {
        if (i % 4 < 3) picture.rgb.push_back(static_cast<unsigned char>(255.0f * floats[i] + 0.5f));
    }
    std::ofstream(name, std::ios::binary) << encode_png(picture);
}

void run(const std::string& cave, const std::string& scene_file, const std::string& name,
         int frames, const std::string& pictures) {
    const OctreeFile file = OctreeFile::open(cave);
    const OctreeView& octree = file.view();
    Start start = start_of(octree, scene_file, name);
    const Context context = Context::headless();
    LightField links(context, octree, start.scene);
    LightField cones(context, octree, start.scene,
                     {.gather = Gather::kCones, .faithful = true, .tricubic = false});
    links.converge();
    cones.iterate(3);
    Frame frame(context, octree);
    frame.set_panels(start.scene.area_lights);
    Display display;

    fmt::print("{}: {} points, {} lobes, {} lamps\n", context.device().renderer,
               octree.surfels.size(), octree.lobes.size(),
               start.scene.point_lights.size() + start.scene.spot_lights.size() +
                   start.scene.area_lights.size());
    for (const auto& [width, height] : {std::pair{800, 600}, {1600, 900}}) {
        start.camera.width = width;
        start.camera.height = height;
        View view = view_of(start.camera);
        const Vec3d eye = view.position;
        const Texture shown("shown", GL_RGBA8, width, height);
        Sprites sprites(octree, width, height);
        const double stops = 0.0;
        const auto show = [&](const Buffer& beauty, PassTimer& timer) {
            timer.measure("tone map", [&] { display.draw(beauty, shown, stops, ToneCurve::kAgx); });
        };
        const auto draw_ours = [&](PassTimer& timer) {
            frame.draw(view, links, Frame::Missing::kAskFor, &timer);
            show(frame.beauty(), timer);
        };
        const auto draw_paper = [&](PassTimer& timer) {
            timer.measure("filter, gather", [&] { cones.iterate(1, false); });
            timer.measure("sprites", [&] { sprites.draw(octree, frame.gbuffer(), kSpriteScale); });
            Buffer beauty;
            timer.measure("shade", [&] {
                beauty = Buffer::of("sprites' beauty",
                                    std::span<const gpu::vec4>(sprites.shade(view, cones)));
            });
            show(beauty, timer);
        };
        PassTimer first(context.device());
        frame.draw(view, links, Frame::Missing::kWaitFor);
        draw_ours(first);
        if (!pictures.empty()) write_picture(shown, fmt::format("{}.{}.ours.png", pictures, width));
        draw_paper(first);
        if (!pictures.empty())
            write_picture(shown, fmt::format("{}.{}.paper.png", pictures, width));

        Frames ours(context, "ours, light at rest"), paper(context, "paper, light at rest");
        for (int i = 0; i < frames; ++i) {
            view.position = eye + view.right * (kStep * (i % 2));
            ours.time(draw_ours);
            paper.time(draw_paper);
        }
        Frames ours_moving(context, "ours, light moving"),
            paper_moving(context, "paper, light moving");
        for (int i = 0; i < frames; ++i) {
            const Scene scene = with_lamps_moved(start.scene, i);
            ours_moving.time([&](PassTimer& timer) {
                timer.measure("direct light, bounce", [&] {
                    links.set_scene(scene);
                    links.iterate(1, false);
                });
                draw_ours(timer);
            });
            paper_moving.time([&](PassTimer& timer) {
                timer.measure("direct light", [&] {
                    cones.set_scene(scene);
                    cones.read_direct();
                });
                draw_paper(timer);
            });
        }
        links.set_scene(start.scene);
        cones.set_scene(start.scene);
        links.iterate(1);
        fmt::print("{}x{}, {} points drawn, {} hidden\n", width, height, frame.surfels_drawn(),
                   frame.surfels_hidden());
        compare("light at rest", ours, paper);
        compare("light moving", ours_moving, paper_moving);
    }
    for (const std::string& error : context.errors())
        fmt::print("OpenGL: {}\n", error);
}

}  // namespace
}  // namespace glowworm

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr,
                   "usage: bench_frame CAVE.svo [SCENE.json [CAMERA [FRAMES [PICTURES]]]]\n");
        return 2;
    }
    try {
        glowworm::run(argv[1], argc > 2 ? argv[2] : "", argc > 3 ? argv[3] : "",
                      argc > 4 ? std::atoi(argv[4]) : 3, argc > 5 ? argv[5] : "");
    } catch (const std::exception& error) {
        fmt::print(stderr, "{}\n", error.what());
        return 1;
    }
}
