#include "preprocess/command/first_frame.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

#include "octree/error.h"

extern char** environ;

namespace glowworm {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr auto kLongestDrawing = std::chrono::minutes(5);
constexpr int kGlance = 100;   // ms
constexpr int kPatience = 50;  // glances, from SIGTERM to SIGKILL

/// A program that runs with its stderr at hand; ended, and waited for, with its scope.
class Child {
  public:
    explicit Child(std::vector<std::string> words) {
        std::vector<char*> argv;
        for (std::string& word : words)
            argv.push_back(word.data());
        argv.push_back(nullptr);
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) return;
        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        for (const int stream : {0, 1})
            posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
        posix_spawn_file_actions_adddup2(&actions, ends[1], 2);
        if (::posix_spawn(&process_, argv[0], &actions, nullptr, argv.data(), environ) != 0)
            process_ = -1;
        posix_spawn_file_actions_destroy(&actions);
        ::close(ends[1]);
        said_ = ends[0];
    }
    ~Child() {
        if (process_ > 0) ::kill(process_, SIGTERM);
        for (int i = 0; i < kPatience && process_ > 0; ++i) {
            if (::waitpid(process_, nullptr, WNOHANG) != 0) process_ = -1;
            std::this_thread::sleep_for(std::chrono::milliseconds(kGlance));
        }
        if (process_ > 0) ::kill(process_, SIGKILL);  // stuck in its driver
        wait();
        if (said_ >= 0) ::close(said_);
    }
    Child(const Child&) = delete;
    Child& operator=(const Child&) = delete;

    /// Appends what it says within a glance; false once it says no more.
    bool listen(std::string& text) const {
        pollfd at{said_, POLLIN, 0};
        if (said_ < 0) return false;
        if (::poll(&at, 1, kGlance) <= 0) return true;
        char block[4096];
        const ssize_t size = ::read(said_, block, sizeof(block));
        if (size > 0) text.append(block, static_cast<std::size_t>(size));
        return size > 0;
    }

    /// Whether it ended well.
    bool wait() {
        int status = 1;
        if (process_ > 0) ::waitpid(process_, &status, 0);
        process_ = -1;
        return WIFEXITED(status) && WEXITSTATUS(status) == 0;
    }

  private:
    pid_t process_ = -1;
    int said_ = -1;
};

/// Follows the lines of --progress json: shows the phases, keeps the last error.
class Listener {
  public:
    explicit Listener(Console& console) : console_(console) {}

    void hear(std::string& text) {
        for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1))
            hear_line(text.substr(0, end));
    }
    const std::string& error() const { return error_; }

  private:
    void hear_line(const std::string& text) {
        const auto line = nlohmann::json::parse(text, nullptr, false);
        if (!line.is_object()) return;
        if (line.value("log", "") == "error") error_ = line.value("sentence", "");
        if (!line.contains("phase")) return;
        const std::string phase = line.value("phase", "");
        if (phase != phase_) progress_ = console_.phase("draw: " + phase, line.value("unit", ""));
        phase_ = phase;
        progress_(line.value("done", std::uint64_t{0}), line.value("total", std::uint64_t{0}));
    }

    Console& console_;
    Progress progress_;
    std::string phase_, error_;
};

std::string content_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace

FirstFrame draw_first_frame(const fs::path& octree, const fs::path& picture, Console& console) {
    std::error_code failed;
    const fs::path viewer =
        fs::read_symlink("/proc/self/exe", failed).replace_filename("glowworm-view");
    if (!fs::exists(viewer, failed))
        return {{}, "There is no frame: glowworm-view is not beside glowworm."};

    console.phase("draw", "pixels");
    Child child({viewer.string(), "--headless", "--size", "960x540", "--bounces", "4", "--force",
                 "--progress", "json", "-o", picture.string(), "--", octree.string()});
    Listener listener(console);
    const auto latest = Clock::now() + kLongestDrawing;
    std::string said;
    while (child.listen(said)) {
        throw_if_cancelled();
        listener.hear(said);
        if (Clock::now() > latest)
            return {{}, "There is no frame: glowworm-view had not drawn it after five minutes."};
    }
    const bool drawn = child.wait();
    throw_if_cancelled();
    console.end_phase();
    FirstFrame frame;
    if (drawn) frame.png = content_of(picture);
    fs::remove(picture, failed);
    if (frame.png.empty()) {
        const std::string& why = listener.error().empty() ? said : listener.error();
        frame.why_not = fmt::format("glowworm-view could not draw here: {}.",
                                    why.empty() ? "it ended without a word" : why);
    }
    return frame;
}

}  // namespace glowworm
