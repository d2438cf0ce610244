#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace glowworm {

/// A regular file open for reading at any place. Not mapped: a file that shrinks under a map is a
/// SIGBUS, here it is a short read.
class InputFile {
  public:
    /// Throws Error (kUnreadable) where the path is missing, not permitted, a folder, a pipe or a
    /// device, or where the file is empty.
    explicit InputFile(std::filesystem::path path);
    ~InputFile();
    InputFile(InputFile&& other) noexcept;
    InputFile& operator=(InputFile&&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::uint64_t size() const { return size_; }  ///< bytes

    /// Copies up to `bytes` bytes from `offset` on; returns how many there were, fewer only at the
    /// end of the file.
    std::size_t read_some(std::uint64_t offset, void* into, std::size_t bytes) const;

    /// Copies exactly `bytes` bytes; throws Error (kUnreadable) where the file ends before.
    void read_exactly(std::uint64_t offset, void* into, std::size_t bytes) const;

    /// Throws Error (kUnreadable): "cannot read 'path': " and the reason, a clause that says what
    /// is wrong and what to do.
    [[noreturn]] void fail(const std::string& reason) const;

  private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_ = 0;
};

}  // namespace glowworm
