#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "octree/node_layout.h"

namespace glowworm {

/// Consecutive surfels of a chunk on their way from the mapped file to the GPU.
struct SurfelRun {
    std::uint32_t chunk = 0;
    std::uint32_t first_block = 0;          ///< of the chunk
    std::vector<std::uint32_t> slots;       ///< on the GPU, one a block
    std::span<const PackedSurfel> in_file;  ///< read only by the reader's thread
    std::vector<PackedSurfel> surfels;      ///< a copy, once it has been read
};

/// Reads runs beside the thread that draws, which never waits for the disk behind a mapped file.
/// The mapping must outlive it.
class SurfelReader {
  public:
    SurfelReader();
    SurfelReader(const SurfelReader&) = delete;
    SurfelReader& operator=(const SurfelReader&) = delete;

    void read(SurfelRun run);             ///< later; in the order given
    std::vector<SurfelRun> finished();    ///< those read since, in the order given
    std::vector<SurfelRun> finish_all();  ///< waits for all that was given
    std::size_t blocks_under_way() const { return blocks_under_way_; }

  private:
    void work(const std::stop_token& stop);

    std::size_t blocks_under_way_ = 0;  // of the drawing thread: given and not taken back
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::deque<SurfelRun> waiting_;
    std::vector<SurfelRun> read_;
    std::size_t unread_ = 0;  // runs
    std::jthread thread_;     // last: it uses the others
};

}  // namespace glowworm
