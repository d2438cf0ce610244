#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <memory>
#include <thread>
#include <vector>

#include "octree/links.h"
#include "viewer/light/bounce.h"

namespace glowworm {

/// Traces an octree's links beside the window's thread, so that it keeps drawing: a few rays of
/// every lobe first, then as many again, until there are all, by a tracer of the octree, which must
/// outlive it.
/// Destroyed before it is done, it cancels.
class LinkWorker {
  public:
    LinkWorker(const OctreeView& octree, const LinkSettings& settings,
               std::shared_ptr<const RayTracer> tracer);
    ~LinkWorker();
    LinkWorker(const LinkWorker&) = delete;
    LinkWorker& operator=(const LinkWorker&) = delete;

    double share_done() const { return share_done_; }  ///< of all rays, 0..1
    /// Rays that every lobe has by now, at first 0; rethrows what went wrong.
    std::uint32_t rays_ready() const;
    /// So many of each lobe's rays, at most those that are ready. Valid as long as this.
    LinkRows first_rays(std::uint32_t rays) const { return {links_, settings_.rays, rays}; }

  private:
    void trace(const OctreeView& octree, std::shared_ptr<const RayTracer> rays_of);

    LinkSettings settings_;
    std::atomic<double> share_done_ = 0.0;
    std::atomic<bool> cancelled_ = false, failed_ = false;
    std::atomic<std::uint32_t> rays_ready_ = 0;
    std::vector<std::uint32_t> links_;
    std::exception_ptr failure_;
    std::thread thread_;
};

}  // namespace glowworm
