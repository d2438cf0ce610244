#pragma once

#include <filesystem>
#include <string>

namespace glowworm {

/// A folder of numbered frames that appears, or gets its frames, once all of them are there.
/// Destroyed before `finish`, it leaves nothing behind.
class FrameFolder {
  public:
    /// Throws Error before any work: kUsage where `path` is there and no folder, kExists where it
    /// holds frames already and `force` is not set, kUnreadable where it cannot be written.
    static void require_writable(const std::filesystem::path& path, bool force);

    /// `ending` is ".png" or ".exr".
    FrameFolder(const std::filesystem::path& path, const std::string& ending);
    ~FrameFolder();
    FrameFolder(const FrameFolder&) = delete;
    FrameFolder& operator=(const FrameFolder&) = delete;

    /// Where frame `number` is to be written until the folder is finished.
    std::filesystem::path frame(int number) const;
    /// The frames take the place of an earlier flight's, what that had more goes; other files
    /// stay. Throws Error (kUnreadable) where one cannot be moved or removed.
    void finish() const;

  private:
    std::filesystem::path path_, unfinished_;
    std::string ending_;
    bool existed_;
    int descriptor_ = -1;  // holds the unfinished folder
};

}  // namespace glowworm
