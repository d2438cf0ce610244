#include "desktop.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <thread>

#include "program.h"

extern char** environ;

namespace glowworm::testing {
namespace {

constexpr const char* kServer = "/usr/bin/Xvfb";
constexpr const char* kHand = "/usr/bin/xdotool";

void pause(double seconds) {
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
}

}  // namespace

RunningProgram::RunningProgram(const std::vector<std::string>& words,
                               const std::vector<std::string>& environment,
                               const std::filesystem::path& folder,
                               const std::filesystem::path& output) {
    std::vector<char*> argv, variables;
    for (const std::string& word : words)
        argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    for (const std::string& variable : environment)
        variables.push_back(const_cast<char*>(variable.c_str()));
    for (char** inherited = environ; *inherited != nullptr; ++inherited) {
        if (std::strncmp(*inherited, "DISPLAY=", 8) != 0) variables.push_back(*inherited);
    }
    variables.push_back(nullptr);

    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                     0644);
    posix_spawn_file_actions_adddup2(&actions, 1, 2);
    const int failed =
        ::posix_spawn(&process_, argv[0], &actions, nullptr, argv.data(), variables.data());
    posix_spawn_file_actions_destroy(&actions);
    if (failed != 0) throw std::runtime_error("cannot run " + words[0]);
}

RunningProgram::~RunningProgram() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    if (wait(10.0) >= 0 || process_ <= 0) return;
    ::kill(process_, SIGKILL);
    wait(10.0);
}

int RunningProgram::wait(double seconds) {
    int status = 0;
    const bool ended =
        wait_for([&] { return ::waitpid(process_, &status, WNOHANG) == process_; }, seconds);
    if (!ended) return -1;
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool wait_for(const std::function<bool()>& condition, double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!condition()) {
        if (std::chrono::steady_clock::now() > end) return false;
        pause(0.05);
    }
    return true;
}

bool Desktop::is_available() {
    return ::access(kServer, X_OK) == 0 && ::access(kHand, X_OK) == 0;
}

Desktop::Desktop(int width, int height, const std::filesystem::path& folder)
    : number_file_(folder / "display-number"),
      // The server picks a free number and tells it on descriptor 1. Without -noreset it would
      // start over, and refuse whoever comes then, each time its last client leaves.
      // Nor does it repeat a key that a busy machine lets go late (-r).
      server_({kServer, "-displayfd", "1", "-noreset", "-r", "-screen", "0",
               std::to_string(width) + "x" + std::to_string(height) + "x24", "-nolisten", "tcp"},
              {}, folder, number_file_) {
    // It complains on the same file of every number that is taken; the free one comes last.
    std::string line;
    const bool started = wait_for([&] {
        std::ifstream said(number_file_);
        while (std::getline(said, line) &&
               (line.empty() || line.find_first_not_of("0123456789") != std::string::npos)) {
        }
        return bool(said);
    });
    if (!started) throw std::runtime_error("Xvfb did not start");
    display_ = ":" + line;
}

bool Desktop::focus(const std::string& title) const {
    std::string window;
    const bool found = wait_for([&] {
        window = run_program("/usr/bin/env", {"DISPLAY=" + display_, kHand, "search",
                                              "--onlyvisible", "--name", title})
                     .out;
        window = window.substr(0, window.find('\n'));
        return !window.empty();
    });
    if (!found) return false;
    tell({"windowmove", window, "0", "0"});
    tell({"windowfocus", window});
    pause(0.8);
    return true;
}

void Desktop::resize(int width, int height) const {
    tell({"getwindowfocus", "windowsize", std::to_string(width), std::to_string(height)});
    pause(0.8);
}

void Desktop::hide_for_a_moment() const {
    tell({"getwindowfocus", "windowunmap", "sleep", "0.5", "windowmap", "windowfocus"});
    pause(0.8);
}

void Desktop::key(const std::string& name) const {
    tell({"key", name});
    pause(0.8);
}

void Desktop::hold(const std::string& name, double seconds) const {
    tell({"keydown", name});
    pause(seconds);
    tell({"keyup", name});
    pause(0.8);
}

void Desktop::click(int x, int y) const {
    tell({"mousemove", std::to_string(x), std::to_string(y)});
    pause(0.8);
    tell({"click", "1"});
    pause(1.5);  // longer than a double click takes
}

void Desktop::drag(int from_x, int from_y, int to_x, int to_y) const {
    tell({"mousemove", std::to_string(from_x), std::to_string(from_y)});
    pause(0.8);
    tell({"mousedown", "1"});
    tell({"mousemove", std::to_string(to_x), std::to_string(to_y)});
    pause(0.8);
    tell({"mouseup", "1"});
    pause(0.8);
}

void Desktop::tell(const std::vector<std::string>& words) const {
    std::vector<std::string> arguments{"DISPLAY=" + display_, kHand};
    arguments.insert(arguments.end(), words.begin(), words.end());
    const Ended ended = run_program("/usr/bin/env", arguments);
    if (ended.code != 0) throw std::runtime_error("xdotool " + words[0] + ": " + ended.err);
}

}  // namespace glowworm::testing
