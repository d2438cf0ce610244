#pragma once

#include <cstdint>

#include "octree/progress.h"

namespace glowworm {

/// Shows how far the look has come, and lets the stages after it hear whether to stop.
class Listening {
  public:
    explicit Listening(const Progress& progress) : progress_(progress) {}

    /// Of the look.
    Progress shown() {
        if (!progress_) return {};
        return [this](std::uint64_t done, std::uint64_t total) {
            done_ = done;
            total_ = total;
            progress_(done, total);
        };
    }
    /// Of a stage: shows nothing new.
    Progress heard() const {
        if (!progress_) return {};
        return [this](std::uint64_t, std::uint64_t) { progress_(done_, total_); };
    }

  private:
    const Progress& progress_;
    std::uint64_t done_ = 0, total_ = 0;
};

}  // namespace glowworm
