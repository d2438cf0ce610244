#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

namespace glowworm {

/// Lets a program work on more than it may keep in memory. While it lives, blocks of a megabyte and
/// more that `new` hands out are files without a name, mapped; whenever what the program occupies
/// comes near the limit, their pages and those of mapped octrees go back to the system, which
/// writes them and brings them again where they are touched. What is computed does not depend on
/// it, only how long that takes. Blocks may outlive it. One at a time.
class PagedMemory {
  public:
    /// `folder` is where the files go, on a disk: a folder in memory saves none. `limit` is in
    /// bytes, of all that the program occupies. To be made by the thread that does the work. Throws
    /// Error (kBudget) where the system has no addresses left for it, or the folder no files
    /// without a name.
    PagedMemory(const std::filesystem::path& folder, std::uint64_t limit);
    ~PagedMemory();
    PagedMemory(const PagedMemory&) = delete;
    PagedMemory& operator=(const PagedMemory&) = delete;

  private:
    class Threads;
    std::unique_ptr<Threads> threads_;
};

}  // namespace glowworm
