#include "viewer/app/flight.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>

#include "octree/output_path.h"
#include "viewer/app/default_scene.h"
#include "viewer/app/frame_folder.h"
#include "viewer/app/picture_file.h"
#include "viewer/app/video_encoder.h"
#include "viewer/frame/exposure.h"
#include "viewer/frame/exr.h"
#include "viewer/frame/png.h"

namespace glowworm {
namespace {

constexpr double kAdaptionRate = 4.0;       // 1/s
constexpr double kHeadlampStep = 0.05;      // m
constexpr int kBouncesAStep = 12;           // at most, while the headlamp moves
constexpr double kCarriedTolerance = 1e-3;  // relative change that nobody sees in a moving picture

/// Where a flight's frames go: into a video or into a folder.
class FlightOutput {
  public:
    FlightOutput(const Options& options, const View& first, double fps)
        : exr_(options.frame_format == "exr") {
        if (is_video_name(options.output)) {
            video_ = std::make_unique<VideoEncoder>(options.output, first.width, first.height, fps);
        } else {
            folder_ = std::make_unique<FrameFolder>(options.output, exr_ ? ".exr" : ".png");
        }
    }

    bool exposed() const { return !exr_; }

    void add(int number, const FrameLayers& layers, const View& view, double stops,
             ToneCurve curve) {
        if (exr_) {
            write_whole(folder_->frame(number), encode_exr(layers, view));
            return;
        }
        const Picture picture = display_.picture_of(layers, stops, curve);
        if (video_) {
            video_->add(picture);
        } else {
            write_whole(folder_->frame(number), encode_png(picture));
        }
    }

    void finish() {
        if (video_) video_->finish();
        if (folder_) folder_->finish();
    }

  private:
    bool exr_;
    Display display_;
    std::unique_ptr<VideoEncoder> video_;
    std::unique_ptr<FrameFolder> folder_;
};

/// From what was reflected before, unless so many bounces are asked for.
void reflect(LightField& light, const Options& options) {
    if (options.bounces) {
        light.forget_indirect();
        light.iterate(*options.bounces);
    } else {
        light.converge(kCarriedTolerance, kBouncesAStep);
    }
}

/// The lamp on the flyer's helmet, where the scene is our own.
class CarriedLamp {
  public:
    CarriedLamp(const Start& start, const Options& options)
        : scene_(start.scene), at_(start.camera.position), options_(options) {
        for (PointLight& light : scene_.point_lights) {
            if (options.scene.empty() && light.name == kHeadlampName) lamp_ = &light;
        }
    }

    const Scene& scene() const { return scene_; }

    /// Moves it to where `camera` is; what was reflected before is where the bounces start from.
    void carry_to(const Camera& camera, LightField& light) {
        if (lamp_ == nullptr || length(camera.position - at_) < kHeadlampStep) return;
        at_ = camera.position;
        lamp_->position = headlamp_at(camera, 0.0f).position;
        light.set_scene(scene_);
        reflect(light, options_);
    }

  private:
    Scene scene_;
    PointLight* lamp_ = nullptr;
    Vec3d at_;
    const Options& options_;
};

/// The flight's camera at a frame. A video's pictures have even edges: its chroma is halved.
Camera camera_of_frame(const CameraPath& path, int frame, const Start& start,
                       const Options& options) {
    Camera camera = sized_camera(camera_at(path, frame, start.camera), options);
    if (is_video_name(options.output)) {
        camera.width += camera.width % 2;
        camera.height += camera.height % 2;
    }
    return camera;
}

}  // namespace

CameraPath prepare_flight(const Options& options) {
    if (is_video_name(options.output)) {
        require_writable_output(options.output, options.force);
        find_ffmpeg();
    } else {
        FrameFolder::require_writable(options.output, options.force);
    }
    require_distinct(options.output, {options.octree, options.scene, options.path});
    return read_camera_path(options.path);
}

nlohmann::ordered_json render_flight(const Context& context, const Cave& cave, LightField& light,
                                     GroupedLight* grouped, const Start& start,
                                     const CameraPath& path, const Options& options,
                                     const Progress& progress) {
    const int count = frame_count(path);
    const double share = 1.0 - std::exp(-kAdaptionRate / path.fps);
    const Camera first = camera_of_frame(path, 0, start, options);
    FlightOutput output(options, view_of(first), path.fps);
    CarriedLamp lamp(start, options);
    Frame frame(context, cave.points(), options.frame);
    frame.set_panels(start.scene.area_lights);

    DisplaySettings display = options.display;
    std::uint64_t without_room = 0;
    for (int i = 0; i < count; ++i) {
        const Camera camera = camera_of_frame(path, i, start, options);
        if (grouped != nullptr && grouped->is_far_from(camera.position)) {
            grouped->look_from(std::span(&camera.position, 1), lamp.scene(), light);
            reflect(light, options);
        }
        lamp.carry_to(camera, light);
        const View view = view_of(camera);
        const FrameLayers layers = frame.render(view, light);
        without_room = std::max(without_room, frame.surfels_without_room());
        if (!options.display.exposure && output.exposed()) {
            const double wanted = measured_exposure(layers);
            const double before = display.exposure.value_or(wanted);
            display.exposure = before + (wanted - before) * share;
        }
        output.add(i, layers, view, display.exposure.value_or(0.0), display.curve);
        cave.file.require_intact();
        progress(static_cast<std::uint64_t>(i) + 1, static_cast<std::uint64_t>(count));
    }
    output.finish();
    if (without_room > 0) {
        spdlog::warn(
            "drawn coarser than it is: --gpu-memory has no room for up to {} of the points that a "
            "frame of this path wants",
            without_room);
    }
    return {{"frames", count}, {"fps", path.fps}, {"width", first.width}, {"height", first.height}};
}

}  // namespace glowworm
