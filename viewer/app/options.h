#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "viewer/app/controls.h"
#include "viewer/frame/display.h"
#include "viewer/frame/frame.h"
#include "viewer/light/settings.h"

namespace glowworm {

struct PictureSize {
    int width, height;  ///< pixels, 1..16384
};

/// The command line, checked.
struct Options {
    std::filesystem::path octree;
    std::filesystem::path scene;       ///< empty: a scene of our own
    std::filesystem::path output;      ///< headless only
    std::filesystem::path probes;      ///< empty: a frame
    std::filesystem::path path;        ///< empty: a frame; else a flight, into a video or a folder
    std::string frame_format = "png";  ///< of a flight's folder: png or exr
    std::string camera;                ///< empty: the scene's first
    std::optional<PictureSize> size;   ///< empty: the camera's, or the window's own
    std::optional<int> bounces;        ///< empty: until the light settles
    std::optional<int> frames;         ///< a window closes after so many, a benchmark draws them
    std::filesystem::path stats;       ///< headless only: what a benchmark writes
    bool headless = false;
    ControlScheme controls = ControlScheme::kFly;  ///< a window's

    LightSettings light;
    std::optional<std::uint32_t> light_depth;  ///< empty: the file's
    /// Bytes, 0: any. The default lets nothing of light be larger than OpenGL must be able to bind.
    std::uint64_t light_memory = std::uint64_t{3} << 29;
    FrameSettings frame;
    DisplaySettings display;

    bool force = false;
    bool json = false;
    bool quiet = false, verbose = false;
    std::string progress = "auto";
    std::filesystem::path log_file;
    int threads = 0;  ///< 0: all
};

/// `camera` with the size that `options` ask for.
Camera sized_camera(const Camera& camera, const Options& options);

/// Reads the command line. Empty where --help or --version was asked for and has been printed.
/// Throws Error (kUsage) for what does not fit.
std::optional<Options> read_options(int argc, char** argv);

}  // namespace glowworm
