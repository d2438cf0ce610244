#include "viewer/app/link_worker.h"

#include "octree/error.h"

namespace glowworm {

LinkWorker::LinkWorker(const OctreeView& octree, const LinkSettings& settings) {
    thread_ = std::thread([this, octree, settings] {
        try {
            links_ = trace_links(octree, settings, [this](std::uint64_t done, std::uint64_t total) {
                if (cancelled_) throw Error(ExitCode::kCancelled, "cancelled");
                share_done_ = total > 0 ? double(done) / double(total) : 0.0;
            });
        } catch (...) {
            failure_ = std::current_exception();
        }
        finished_ = true;
    });
}

LinkWorker::~LinkWorker() {
    cancelled_ = true;
    if (thread_.joinable()) thread_.join();
}

std::optional<std::vector<std::uint32_t>> LinkWorker::take() {
    if (!finished_ || !thread_.joinable()) return std::nullopt;
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    return std::move(links_);
}

}  // namespace glowworm
