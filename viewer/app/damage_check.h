#pragma once

#include <atomic>
#include <optional>
#include <thread>

#include "octree/checksums.h"

namespace glowworm {

/// Compares a file's checksums beside the window's thread: all of it is read for that, which takes
/// a second for every few GB, and minutes from a slow disk. Destroyed before it is done, it stops.
class DamageCheck {
  public:
    explicit DamageCheck(const OctreeFile& file);

    /// What is damaged, a sentence each, once, when that is known.
    std::optional<Sentences> take();

  private:
    Sentences sentences_;
    std::atomic<bool> done_ = false;
    std::jthread thread_;  // the last: it ends before what it writes to
};

}  // namespace glowworm
