#pragma once

#include <sys/types.h>

#include <filesystem>

#include "octree/atomic_file.h"
#include "viewer/frame/layers.h"

namespace glowworm {

/// Whether `path` names a video by its ending: .mp4, .m4v, .mov or .mkv.
bool is_video_name(const std::filesystem::path& path);

/// The program `ffmpeg` on the PATH. Throws Error (kUsage) where there is none.
std::filesystem::path find_ffmpeg();

/// Pictures become an H.264 video by way of an ffmpeg process that they are piped to. The video
/// appears under its name once it is whole; destroyed before `finish`, it leaves nothing behind.
class VideoEncoder {
  public:
    /// Pictures of `width` x `height` pixels, both even as yuv420p wants them, `fps` a second.
    VideoEncoder(const std::filesystem::path& path, int width, int height, double fps);
    ~VideoEncoder();
    VideoEncoder(const VideoEncoder&) = delete;
    VideoEncoder& operator=(const VideoEncoder&) = delete;

    /// Throws Error (kUnreadable) with ffmpeg's own words where it has given up.
    void add(const Picture& picture);
    void finish();

  private:
    void close_pipe();
    /// Waits for ffmpeg to end; 0 where all went well.
    int wait();
    [[noreturn]] void fail();

    AtomicFile file_;
    int pipe_ = -1, messages_ = -1;  // descriptors
    pid_t process_ = -1;
};

}  // namespace glowworm
