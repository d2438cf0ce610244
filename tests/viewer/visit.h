#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "desktop.h"
#include "testing.h"

namespace glowworm::testing {

std::string text_of(const std::filesystem::path& path);
nlohmann::json json_of(const std::filesystem::path& path);

/// How somebody comes to a window.
struct Arrival {
    std::vector<std::string> flags;
    bool own_scene = false;  ///< the viewer's own, not scene.json
    std::string size = "320x240";
    int screen_width = 320, screen_height = 240;
    int dots_per_inch = 96;  ///< of the screen
    std::vector<std::string> environment;
};

/// Somebody at a window on a room of 4 x 4 x 3 m, looking north from (2, 0.5, 1.5).
class Visit {
  public:
    static constexpr int kWidth = 320, kHeight = 240;

    explicit Visit(const Arrival& arrival);

    std::string file(const std::string& name) const { return (folder_ / name).string(); }
    const Desktop& desktop() const { return desktop_; }
    std::string log() const { return text_of(folder_ / "log"); }
    /// Whether the viewer says that, `times` times, or soon will have.
    bool says(const std::string& sentence, int times = 1) const;

    /// The window is there, has drawn, and has the keyboard; its panels are hidden.
    bool begin();
    /// F12; the picture's number.
    bool save_picture(int number);
    bool wait_for_file(const std::string& name) const;
    std::vector<float> red(int number) const;
    double mean_red(int number) const;
    /// The exit code after Escape.
    int end();

  private:
    ScratchFolder folder_;
    Desktop desktop_;
    std::unique_ptr<RunningProgram> viewer_;
};

}  // namespace glowworm::testing

#define DESKTOP_OR_SKIP()                                       \
    if (!glowworm::testing::Desktop::is_available())            \
    GTEST_SKIP() << "Xvfb or xdotool is missing: no hand on a " \
                    "window"
