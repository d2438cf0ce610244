#include "viewer/frame/surfel_reader.h"

#include <utility>

namespace glowworm {

SurfelReader::SurfelReader() : thread_([this](const std::stop_token& stop) { work(stop); }) {}

void SurfelReader::read(SurfelRun run) {
    blocks_under_way_ += run.slots.size();
    {
        const std::scoped_lock lock(mutex_);
        waiting_.push_back(std::move(run));
        ++unread_;
    }
    changed_.notify_all();
}

std::vector<SurfelRun> SurfelReader::finished() {
    const std::scoped_lock lock(mutex_);
    for (const SurfelRun& run : read_)
        blocks_under_way_ -= run.slots.size();
    return std::exchange(read_, {});
}

std::vector<SurfelRun> SurfelReader::finish_all() {
    {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [this] { return unread_ == 0; });
    }
    return finished();
}

void SurfelReader::work(const std::stop_token& stop) {
    std::unique_lock lock(mutex_);
    while (changed_.wait(lock, stop, [this] { return !waiting_.empty(); })) {
        SurfelRun run = std::move(waiting_.front());
        waiting_.pop_front();
        lock.unlock();
        run.surfels.assign(run.in_file.begin(), run.in_file.end());
        lock.lock();
        read_.push_back(std::move(run));
        --unread_;
        changed_.notify_all();
    }
}

}  // namespace glowworm
