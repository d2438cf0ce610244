#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "octree/surfel.h"

namespace glowworm {

/// A folder of its own for temporary files, removed with them at the end of its scope. Those that
/// killed programs left in the same place are removed with it.
class TemporaryFolder {
  public:
    /// Made inside `parent`. Throws Error (kUnreadable) where that cannot be written.
    explicit TemporaryFolder(const std::filesystem::path& parent);
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
    int descriptor_ = -1;  ///< holds the folder
};

/// Surfels put aside on disk, in the order they came. Holds up to `buffered` of them in memory and
/// no file open.
class Spill {
  public:
    Spill(std::filesystem::path file, std::size_t buffered);
    void add(const Surfel& surfel);
    std::uint64_t size() const { return size_; }
    const std::filesystem::path& file() const { return file_; }

    /// All of them again; the file is removed. Throws Error (kUnreadable) where it has been cut.
    std::vector<Surfel> take();

  private:
    void flush();

    std::filesystem::path file_;
    std::size_t buffered_;
    std::vector<Surfel> buffer_;
    std::uint64_t size_ = 0;
};

}  // namespace glowworm
