#include "viewer/app/flight.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "viewer/app/camera_path.h"
#include "viewer/app/picture_file.h"
#include "viewer/frame/exposure.h"

namespace glowworm {
namespace {

constexpr double kAdaptionRate = 4.0;  // 1/s

/// A folder that gets its name when it is whole, and vanishes where it never is.
class NewFolder {
  public:
    explicit NewFolder(const std::filesystem::path& path)
        : path_(path), unfinished_(fmt::format("{}.{}.part", path.string(), ::getpid())) {
        std::error_code failure;
        if (!std::filesystem::create_directory(unfinished_, failure)) {
            throw Error(ExitCode::kUnreadable,
                        fmt::format("the folder '{}' cannot be made", unfinished_.string()));
        }
    }
    NewFolder(const NewFolder&) = delete;
    NewFolder& operator=(const NewFolder&) = delete;
    ~NewFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(unfinished_, ignored);
    }
    const std::filesystem::path& unfinished() const { return unfinished_; }
    void finish() const {
        std::error_code failure;
        std::filesystem::rename(unfinished_, path_, failure);
        if (failure) {
            throw Error(ExitCode::kUnreadable, fmt::format("the folder '{}' cannot be named so: {}",
                                                           path_.string(), failure.message()));
        }
    }

  private:
    std::filesystem::path path_, unfinished_;
};

}  // namespace

nlohmann::ordered_json render_flight(const Context& context, const Cave& cave,
                                     const LightField& light, const Start& start,
                                     const Options& options, const Progress& progress) {
    const CameraPath path = read_camera_path(options.path);
    const NewFolder folder(options.output);
    const int count = frame_count(path);
    Frame frame(context, cave.points(), options.frame);
    frame.set_panels(start.scene.area_lights);
    const double share = 1.0 - std::exp(-kAdaptionRate / path.fps);
    DisplaySettings display = options.display;
    for (int i = 0; i < count; ++i) {
        const View view = view_of(sized_camera(camera_at(path, i, start.camera), options));
        const FrameLayers layers = frame.render(view, light);
        if (!options.display.exposure) {
            const double wanted = measured_exposure(layers);
            const double before = display.exposure.value_or(wanted);
            display.exposure = before + (wanted - before) * share;
        }
        write_frame(layers, view, display, folder.unfinished() / fmt::format("{:06}.png", i));
        cave.file.require_intact();
        progress(static_cast<std::uint64_t>(i) + 1, static_cast<std::uint64_t>(count));
    }
    folder.finish();
    return {{"frames", count}, {"fps", path.fps}};
}

}  // namespace glowworm
