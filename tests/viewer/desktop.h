#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace glowworm::testing {

/// A program that runs while a test goes on; ended where it has not ended by itself.
class RunningProgram {
  public:
    /// `environment` is added as NAME=VALUE; what it says goes into `output`.
    RunningProgram(const std::vector<std::string>& words,
                   const std::vector<std::string>& environment, const std::filesystem::path& folder,
                   const std::filesystem::path& output);
    ~RunningProgram();
    RunningProgram(const RunningProgram&) = delete;
    RunningProgram& operator=(const RunningProgram&) = delete;

    /// Its exit code; -1 where it has not ended within the seconds.
    int wait(double seconds);

  private:
    pid_t process_ = -1;
};

/// True as soon as `condition` is; false after so many seconds.
bool wait_for(const std::function<bool()>& condition, double seconds = 60.0);

/// A screen that nobody sees (Xvfb) and a hand on its mouse and keyboard (xdotool).
class Desktop {
  public:
    /// Whether both programs are there.
    static bool is_available();

    Desktop(int width, int height, const std::filesystem::path& folder);

    const std::string& display() const { return display_; }  ///< ":99"
    /// The window whose title has this in it comes to the front and gets the keyboard.
    bool focus(const std::string& title) const;
    /// The window that has the keyboard; of the screen's pixels.
    void resize(int width, int height) const;
    void hide_for_a_moment() const;
    void key(const std::string& name) const;  ///< "ctrl+s"
    void hold(const std::string& name, double seconds) const;
    void click(int x, int y) const;  ///< pixels of the screen
    void drag(int from_x, int from_y, int to_x, int to_y) const;

  private:
    void tell(const std::vector<std::string>& words) const;

    std::filesystem::path number_file_;
    RunningProgram server_;
    std::string display_;
};

}  // namespace glowworm::testing
