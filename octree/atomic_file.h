#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace glowworm {

/// A file that appears under its final name only when whole: written under a unique temporary name
/// in the same folder, synced, then renamed. Destroyed before `commit`, it leaves nothing behind.
/// All members throw Error: kBudget when the disk is full, kUnreadable when the path cannot be
/// written.
class AtomicFile {
  public:
    explicit AtomicFile(std::filesystem::path final_path);
    ~AtomicFile();
    AtomicFile(AtomicFile&&) noexcept;
    AtomicFile& operator=(AtomicFile&&) = delete;

    void write(const void* data, std::size_t bytes);  ///< appends
    void write(std::string_view text) { write(text.data(), text.size()); }
    void write_at(std::uint64_t offset, const void* data, std::size_t bytes);
    std::uint64_t position() const { return position_; }

    /// For writers that insist on opening a path themselves (libpng, OpenEXR, ffmpeg).
    const std::filesystem::path& temporary_path() const { return temporary_path_; }

    /// Syncs, renames, syncs the folder; only renames where the file is not `synced`. Nothing else
    /// may be called afterwards.
    void commit(bool synced = true);

  private:
    std::filesystem::path final_path_;
    std::filesystem::path temporary_path_;
    int descriptor_ = -1;
    std::uint64_t position_ = 0;
};

}  // namespace glowworm
