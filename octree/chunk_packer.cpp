#include "octree/chunk_packer.h"

#include <tbb/parallel_pipeline.h>

#include <memory>

namespace glowworm {
namespace {

constexpr std::size_t kAhead = 64;  ///< chunks packed or being packed: at most 84 MB

struct PackedChunk {
    Chunk chunk;
    std::vector<PackedSurfel> surfels;
};

}  // namespace

ChunkPacker::ChunkPacker(std::span<const Surfel> surfels, std::span<const CodeIndex> order,
                         const Grid& grid)
    : surfels_(surfels), order_(order), grid_(grid), ranges_(split_into_chunks(order)) {}

void ChunkPacker::pack(SharedProgress& progress, const Take& take) const {
    std::size_t next = 0;
    const auto each_range = [&](tbb::flow_control& flow) {
        if (next == ranges_.size()) flow.stop();
        return next++;
    };
    const auto packed = [&](std::size_t i) {
        const SurfelRange& range = ranges_[i];
        auto out = std::make_shared<PackedChunk>();
        out->surfels.resize(range.size());
        out->chunk =
            pack_chunk(surfels_, order_.subspan(range.begin, range.size()), grid_, out->surfels);
        out->chunk.first = static_cast<std::uint32_t>(range.begin);
        return out;
    };
    const auto taken = [&](const std::shared_ptr<PackedChunk>& done) {
        take(done->chunk, done->surfels);
        progress.add(done->surfels.size());
    };
    using tbb::filter_mode;
    tbb::parallel_pipeline(
        kAhead, tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, each_range) &
                    tbb::make_filter<std::size_t, std::shared_ptr<PackedChunk>>(
                        filter_mode::parallel, packed) &
                    tbb::make_filter<std::shared_ptr<PackedChunk>, void>(
                        filter_mode::serial_in_order, taken));
}

}  // namespace glowworm
