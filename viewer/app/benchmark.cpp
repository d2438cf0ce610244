#include "viewer/app/benchmark.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "viewer/app/picture_file.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

Json spread_of(std::vector<double> ms) {
    std::sort(ms.begin(), ms.end());
    return {{"median", ms[ms.size() / 2]}, {"min", ms.front()}, {"max", ms.back()}};
}

Json spread_of(const std::vector<PassTimer::Sample>& samples) {
    std::vector<double> gpu, cpu;
    for (const PassTimer::Sample& sample : samples) {
        gpu.push_back(sample.gpu_ms);
        cpu.push_back(sample.cpu_ms);
    }
    return {{"gpu_ms", spread_of(std::move(gpu))}, {"cpu_ms", spread_of(std::move(cpu))}};
}

}  // namespace

Json run_benchmark(const Context& context, const Cave& cave, LightField& light, const Start& start,
                   const Options& options) {
    const View view = view_of(sized_camera(start.camera, options));
    Frame frame(context, cave.points(), options.frame);
    frame.set_panels(start.scene.area_lights);
    Display display;
    const Texture shown("shown", GL_RGBA8, view.width, view.height);
    const bool bounces = options.bounces != 0;

    PassTimer warm_up(context.device()), timer(context.device());
    const auto draw = [&](PassTimer& passes) {
        if (bounces) passes.measure("bounce", [&] { light.iterate(1, false); });
        frame.draw(view, light, Frame::Missing::kWaitFor, &passes);
        passes.measure("tone map", [&] {
            display.draw(frame.beauty(), shown, options.display.exposure.value_or(0.0),
                         options.display.curve);
        });
    };
    cave.file.require_intact();
    draw(warm_up);
    for (int i = 0; i < options.frames.value_or(1); ++i)
        draw(timer);

    Json passes = Json::object();
    std::vector<PassTimer::Sample> frames(static_cast<std::size_t>(options.frames.value_or(1)));
    for (const auto& [name, samples] : timer.samples()) {
        passes[name] = spread_of(samples);
        for (std::size_t i = 0; i < frames.size(); ++i) {
            frames[i].gpu_ms += samples[i].gpu_ms;
            frames[i].cpu_ms += samples[i].cpu_ms;
        }
    }
    const Json stats{{"renderer", context.device().renderer},
                     {"width", view.width},
                     {"height", view.height},
                     {"frames", options.frames.value_or(1)},
                     {"points", cave.points().surfels.size()},
                     {"points_drawn", frame.surfels_drawn()},
                     {"points_hidden", frame.surfels_hidden()},
                     {"lobes", cave.light().lobes.size()},
                     {"gpu_clock", context.device().software
                                       ? "wall time of each pass: a software renderer has no GPU"
                                       : "timer queries"},
                     {"passes", passes},
                     {"frame", spread_of(frames)}};
    write_whole(options.stats, stats.dump(2) + "\n");
    return stats;
}

}  // namespace glowworm
