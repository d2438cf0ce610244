#include "viewer/app/video_encoder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "octree/error.h"

extern char** environ;

namespace glowworm {
namespace {

/// What ffmpeg is told. Pictures are sRGB; the video says so and holds BT.709 luma and chroma.
std::vector<std::string> arguments_for(const std::filesystem::path& output, int width, int height,
                                       double fps) {
    std::vector<std::string> words{"ffmpeg", "-nostdin", "-hide_banner", "-loglevel", "error", "-y",
                                   // in: pictures as they lie in memory
                                   "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size",
                                   fmt::format("{}x{}", width, height), "-framerate",
                                   fmt::format("{:.6f}", fps), "-i", "pipe:0",
                                   // out
                                   "-an", "-vf", "scale=out_color_matrix=bt709:out_range=tv",
                                   "-c:v", "libx264", "-preset", "medium", "-crf", "18", "-pix_fmt",
                                   "yuv420p", "-color_primaries", "bt709", "-color_trc",
                                   "iec61966-2-1", "-colorspace", "bt709", "-color_range", "tv"};
    const std::string ending = output.extension().string();
    if (ending != ".mkv") {
        // The index first: such a file plays while it is still being loaded.
        words.insert(words.end(), {"-movflags", "+faststart"});
    }
    words.push_back("file:" + output.string());
    return words;
}

/// A broken pipe is an error of `write`, not the end of this program.
class IgnoredPipeSignal {
  public:
    IgnoredPipeSignal() {
        struct sigaction ignore = {};
        ignore.sa_handler = SIG_IGN;
        ::sigaction(SIGPIPE, &ignore, &before_);
    }
    IgnoredPipeSignal(const IgnoredPipeSignal&) = delete;
    IgnoredPipeSignal& operator=(const IgnoredPipeSignal&) = delete;
    ~IgnoredPipeSignal() { ::sigaction(SIGPIPE, &before_, nullptr); }

  private:
    struct sigaction before_ = {};
};

}  // namespace

bool is_video_name(const std::filesystem::path& path) {
    const std::string ending = path.extension().string();
    for (const char* known : {".mp4", ".m4v", ".mov", ".mkv"}) {
        if (ending == known) return true;
    }
    return false;
}

std::filesystem::path find_ffmpeg() {
    const char* folders = std::getenv("PATH");
    std::istringstream list(folders != nullptr ? folders : "");
    for (std::string folder; std::getline(list, folder, ':');) {
        const auto program = std::filesystem::path(folder.empty() ? "." : folder) / "ffmpeg";
        std::error_code ignored;
        if (std::filesystem::is_regular_file(program, ignored) &&
            ::access(program.c_str(), X_OK) == 0) {
            return program;
        }
    }
    throw Error(ExitCode::kUsage,
                "a video needs the program ffmpeg, which is not on the PATH: install it (Debian: "
                "apt install ffmpeg), or let -o name a folder for numbered frames");
}

VideoEncoder::VideoEncoder(const std::filesystem::path& path, int width, int height, double fps)
    : file_(path) {
    const std::filesystem::path program = find_ffmpeg();
    std::vector<std::string> words = arguments_for(file_.temporary_path(), width, height, fps);
    std::vector<char*> argv;
    for (std::string& word : words)
        argv.push_back(word.data());
    argv.push_back(nullptr);

    std::array<int, 2> ends{-1, -1};
    messages_ = ::memfd_create("what ffmpeg says", MFD_CLOEXEC);
    if (messages_ < 0 || ::pipe2(ends.data(), O_CLOEXEC) != 0) {
        throw Error(ExitCode::kInternal,
                    fmt::format("cannot make a pipe to ffmpeg: {}", std::strerror(errno)));
    }
    pipe_ = ends[1];
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages_, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, messages_, STDERR_FILENO);
    // A group of its own: Ctrl-C reaches this program, which then ends ffmpeg.
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    const int failed =
        ::posix_spawn(&process_, program.c_str(), &actions, &attributes, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    ::close(ends[0]);
    if (failed != 0) {
        process_ = -1;
        close_pipe();
        ::close(messages_);
        throw Error(ExitCode::kInternal,
                    fmt::format("cannot start '{}': {}", program.string(), std::strerror(failed)));
    }
}

VideoEncoder::~VideoEncoder() {
    if (process_ > 0) ::kill(process_, SIGKILL);
    close_pipe();
    wait();
    ::close(messages_);
}

void VideoEncoder::add(const Picture& picture) {
    const IgnoredPipeSignal ignored;
    const unsigned char* next = picture.rgb.data();
    std::size_t left = picture.rgb.size();
    while (left > 0) {
        const ssize_t written = ::write(pipe_, next, left);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) fail();
        next += written;
        left -= static_cast<std::size_t>(written);
    }
}

void VideoEncoder::finish() {
    close_pipe();
    if (wait() != 0) fail();
    file_.commit();
}

void VideoEncoder::close_pipe() {
    if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
}

int VideoEncoder::wait() {
    if (process_ <= 0) return 0;
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
}

void VideoEncoder::fail() {
    close_pipe();
    wait();
    std::array<char, 400> text{};
    const ssize_t bytes = ::pread(messages_, text.data(), text.size(), 0);
    std::string words(text.data(), bytes > 0 ? static_cast<std::size_t>(bytes) : 0);
    words = words.substr(0, words.find('\n'));
    throw Error(ExitCode::kUnreadable,
                fmt::format("ffmpeg could not make the video: {}; let -o name a folder for "
                            "numbered frames",
                            words.empty() ? "it ended without a word" : words));
}

}  // namespace glowworm
