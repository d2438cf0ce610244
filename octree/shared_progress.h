#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "octree/progress.h"

namespace glowworm {

/// Progress that several threads make together. Whoever adds to it while nobody else is reporting
/// reports; what that throws goes up in the thread that called.
class SharedProgress {
  public:
    /// Reports [begin, end) of `total`, in the unit of what is added up to `work`.
    SharedProgress(const Progress& progress, std::uint64_t work, double begin, double end,
                   std::uint64_t total)
        : progress_(progress), work_(work), begin_(begin), end_(end), total_(total) {}

    void add(std::uint64_t done) {
        done_ += done;
        if (!progress_ || !mutex_.try_lock()) return;
        const std::lock_guard lock(mutex_, std::adopt_lock);
        const double part = work_ > 0 ? static_cast<double>(done_) / static_cast<double>(work_) : 1;
        const double now = begin_ + (end_ - begin_) * std::min(part, 1.0);
        progress_(static_cast<std::uint64_t>(now * static_cast<double>(total_)), total_);
    }

  private:
    const Progress& progress_;
    std::uint64_t work_;
    double begin_, end_;
    std::uint64_t total_;
    std::atomic<std::uint64_t> done_{0};
    std::mutex mutex_;
};

}  // namespace glowworm
