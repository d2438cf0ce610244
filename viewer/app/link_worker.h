#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include "octree/links.h"

namespace glowworm {

/// Traces an octree's links beside the window's thread, so that it keeps drawing. The octree must
/// outlive it. Destroyed before it is done, it cancels.
class LinkWorker {
  public:
    LinkWorker(const OctreeView& octree, const LinkSettings& settings);
    ~LinkWorker();
    LinkWorker(const LinkWorker&) = delete;
    LinkWorker& operator=(const LinkWorker&) = delete;

    double share_done() const { return share_done_; }  ///< 0..1
    /// The links, once, when they are ready; rethrows what went wrong.
    std::optional<std::vector<std::uint32_t>> take();

  private:
    std::atomic<double> share_done_ = 0.0;
    std::atomic<bool> cancelled_ = false, finished_ = false;
    std::vector<std::uint32_t> links_;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace glowworm
