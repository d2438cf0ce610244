#include "viewer/app/link_worker.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "octree/error.h"

namespace glowworm {

LinkWorker::LinkWorker(const OctreeView& octree, const LinkSettings& settings,
                       std::shared_ptr<const RayTracer> tracer)
    : settings_(settings) {
    thread_ = std::thread([this, octree, tracer = std::move(tracer)] {
        try {
            trace(octree, tracer);
        } catch (...) {
            failure_ = std::current_exception();
            failed_ = true;
        }
    });
}

LinkWorker::~LinkWorker() {
    cancelled_ = true;
    thread_.join();
}

void LinkWorker::trace(const OctreeView& octree, std::shared_ptr<const RayTracer> rays_of) {
    const LinkTracer tracer(octree, std::move(rays_of));
    std::vector<std::uint32_t> rows(octree.lobes.size());
    std::iota(rows.begin(), rows.end(), 0u);
    links_.resize(rows.size() * settings_.rays);
    LinkRays rays{rows, 0, std::min(kPreviewRays, settings_.rays), settings_.rays, {}};
    while (rays.first < settings_.rays) {
        tracer.trace(rays, links_, [&](std::uint64_t done, std::uint64_t total) {
            if (cancelled_) throw Error(ExitCode::kCancelled, "cancelled");
            const double of_these = total > 0 ? double(done) / double(total) : 1.0;
            share_done_ = (rays.first + of_these * (rays.last - rays.first)) / settings_.rays;
        });
        rays_ready_ = rays.last;
        rays.first = rays.last;
        rays.last = std::min(2 * rays.last, settings_.rays);
    }
}

std::uint32_t LinkWorker::rays_ready() const {
    if (failed_) std::rethrow_exception(failure_);
    return rays_ready_;
}

}  // namespace glowworm
