#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "octree/atomic_file.h"

namespace glowworm {

/// Cuts what is written into E57 pages, each with its checksum.
class E57PageWriter {
  public:
    explicit E57PageWriter(AtomicFile& file) : file_(file) {}

    void write(const void* data, std::size_t bytes);

    /// Fills the last page with zeros. Nothing else may be written afterwards.
    void finish();

    std::uint64_t logical() const { return logical_; }  ///< bytes written so far

  private:
    void end_page();

    AtomicFile& file_;
    std::vector<std::byte> page_;
    std::uint64_t logical_ = 0;
};

}  // namespace glowworm
