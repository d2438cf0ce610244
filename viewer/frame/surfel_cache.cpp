#include "viewer/frame/surfel_cache.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace glowworm {
namespace {

constexpr std::size_t kPageBytes = std::size_t{64} << 20;
constexpr std::size_t kMostUnderWay = 4096;  // blocks: 20 MB are read ahead of the GPU
constexpr std::size_t kLongestRun = 64;      // blocks read at once

std::uint32_t blocks_of(std::uint32_t surfels) {
    return (surfels + SurfelCache::kBlock - 1) / SurfelCache::kBlock;
}

}  // namespace

SurfelCache::SurfelCache(const OctreeView& octree, std::size_t max_page_bytes,
                         std::uint64_t max_bytes)
    : octree_(octree), chunks_(octree.chunks.size()) {
    constexpr std::size_t kBlockBytes = kBlock * sizeof(PackedSurfel);
    page_blocks_ = static_cast<std::uint32_t>(std::min(max_page_bytes, kPageBytes) / kBlockBytes);
    std::uint64_t all = 0, least = 0;
    for (const Chunk& chunk : octree.chunks) {
        all += blocks_of(chunk.count);
        least += chunk.count > 0 ? 1 : 0;
    }
    capacity_ =
        max_bytes > 0 ? std::clamp<std::uint64_t>(max_bytes / kBlockBytes, least, all) : all;
    for (std::uint32_t i = 0; i < octree.chunks.size(); ++i) {
        if (octree.chunks[i].count == 0) continue;
        chunks_[i].slots = take_slots(1);
        put(surfels_of(i, 0, 1), chunks_[i].slots);
    }
}

std::uint64_t SurfelCache::blocks_for(std::size_t shown) const {
    const std::size_t others = chunks_.size() - std::min(shown, chunks_.size());
    return std::max<std::uint64_t>(capacity_ - std::min<std::uint64_t>(others, capacity_), shown);
}

std::uint32_t SurfelCache::resident(std::uint32_t chunk) const {
    const auto blocks = static_cast<std::uint32_t>(chunks_[chunk].slots.size());
    return std::min(blocks * kBlock, octree_.chunks[chunk].count);
}

SurfelCache::Place SurfelCache::place_of(std::uint32_t chunk, std::uint32_t block) const {
    const std::uint32_t slot = chunks_[chunk].slots[block];
    return {slot / page_blocks_, slot % page_blocks_ * kBlock};
}

void SurfelCache::load(std::span<const ChunkSelection> selection) {
    take_in(reader_.finish_all());
    note(selection);
    std::size_t missing = 0;
    for (const ChunkSelection& wanted : selection) {
        const std::size_t here = chunks_[wanted.chunk].slots.size();
        missing += std::max<std::size_t>(blocks_of(wanted.count), here) - here;
    }
    make_room(missing);
    for (const ChunkSelection& wanted : selection) {
        std::vector<std::uint32_t>& slots = chunks_[wanted.chunk].slots;
        const std::size_t here = slots.size(), there = blocks_of(wanted.count);
        if (there <= here) continue;
        const std::vector<std::uint32_t> more = take_slots(there - here);
        put(surfels_of(wanted.chunk, static_cast<std::uint32_t>(here), more.size()), more);
        slots.insert(slots.end(), more.begin(), more.end());
    }
}

bool SurfelCache::request(std::span<const ChunkSelection> selection) {
    take_in(reader_.finished());
    note(selection);
    struct Want {
        std::uint32_t chunk;
        std::size_t blocks;  // more
        double here;         // share of what is wanted
    };
    std::vector<Want> wants;
    std::size_t missing = 0;
    for (const ChunkSelection& wanted : selection) {
        const Resident& chunk = chunks_[wanted.chunk];
        const std::size_t here = chunk.slots.size() + chunk.under_way;
        const std::size_t there = blocks_of(wanted.count);
        if (there <= here) continue;
        // Twice as many at most at a time: a finer level of all comes before the finest of one.
        const std::size_t more =
            std::min({there - here, std::max<std::size_t>(here, 1), kLongestRun});
        wants.push_back({wanted.chunk, more, static_cast<double>(here) / double(there)});
        missing += more;
    }
    std::stable_sort(wants.begin(), wants.end(),
                     [](const Want& a, const Want& b) { return a.here < b.here; });
    const std::size_t places = kMostUnderWay - std::min(kMostUnderWay, reader_.blocks_under_way());
    make_room(std::min(missing, places));
    for (const Want& want : wants) {
        if (reader_.blocks_under_way() + want.blocks > kMostUnderWay) break;
        SurfelRun run;
        run.slots = take_slots(want.blocks);
        if (run.slots.empty()) break;
        Resident& chunk = chunks_[want.chunk];
        run.chunk = want.chunk;
        run.first_block = static_cast<std::uint32_t>(chunk.slots.size()) + chunk.under_way;
        run.in_file = surfels_of(want.chunk, run.first_block, run.slots.size());
        chunk.under_way += static_cast<std::uint32_t>(run.slots.size());
        reader_.read(std::move(run));
    }
    return wants.empty() && reader_.blocks_under_way() == 0;
}

std::span<const PackedSurfel> SurfelCache::surfels_of(std::uint32_t chunk,
                                                      std::uint32_t first_block,
                                                      std::size_t blocks) const {
    const Chunk& record = octree_.chunks[chunk];
    const std::size_t first = std::size_t{first_block} * kBlock;
    const std::size_t count = std::min<std::size_t>(blocks * kBlock, record.count - first);
    return octree_.surfels.subspan(record.first + first, count);
}

/// As many as there are, `count` at most. Pages come into being with the first of their slots.
std::vector<std::uint32_t> SurfelCache::take_slots(std::size_t count) {
    const auto places = [this] { return static_cast<std::uint64_t>(pages_.size()) * page_blocks_; };
    while (free_.size() < count && places() < capacity_) {
        const std::uint64_t first = places();
        const std::uint64_t blocks = std::min<std::uint64_t>(page_blocks_, capacity_ - first);
        pages_.emplace_back("surfel page", blocks * kBlock * sizeof(PackedSurfel));
        std::vector<std::uint32_t> more;
        for (std::uint64_t slot = first + blocks; slot > first; --slot)
            more.push_back(static_cast<std::uint32_t>(slot - 1));
        free_.insert(free_.begin(), more.begin(), more.end());
    }
    count = std::min(count, free_.size());
    std::vector<std::uint32_t> slots(free_.rbegin(),
                                     free_.rbegin() + static_cast<std::ptrdiff_t>(count));
    free_.resize(free_.size() - count);
    return slots;
}

/// Lets go of what the frame does not need until `blocks` are free: other chunks, those unused
/// longest first, then what its own have beyond their part.
void SurfelCache::make_room(std::size_t blocks) {
    const auto lacks_room = [&] {
        const std::uint64_t taken = pages_.size() * std::uint64_t{page_blocks_};
        const std::uint64_t untouched = capacity_ - std::min(capacity_, taken);
        return free_.size() + untouched < blocks;
    };
    if (!lacks_room()) return;
    std::vector<std::uint32_t> by_use(chunks_.size());
    std::iota(by_use.begin(), by_use.end(), 0u);
    std::ranges::stable_sort(by_use, {}, [this](std::uint32_t i) { return chunks_[i].used_at; });
    for (const std::uint32_t chunk : by_use) {
        if (!lacks_room()) return;
        keep_first(chunk, chunks_[chunk].used_at == frames_ ? chunks_[chunk].wanted : 1);
    }
}

void SurfelCache::keep_first(std::uint32_t chunk, std::size_t blocks) {
    std::vector<std::uint32_t>& slots = chunks_[chunk].slots;
    while (slots.size() > blocks) {
        free_.push_back(slots.back());
        slots.pop_back();
    }
}

void SurfelCache::put(std::span<const PackedSurfel> surfels, std::span<const std::uint32_t> slots) {
    for (std::size_t i = 0; i < slots.size();) {
        std::size_t end = i + 1;  // neighbours go together
        while (end < slots.size() && slots[end] == slots[end - 1] + 1 &&
               slots[end] % page_blocks_ != 0) {
            ++end;
        }
        const std::size_t first = i * kBlock, last = std::min(end * kBlock, surfels.size());
        pages_[slots[i] / page_blocks_].write(surfels.subspan(first, last - first),
                                              std::size_t{slots[i] % page_blocks_} * kBlock);
        i = end;
    }
}

void SurfelCache::take_in(std::vector<SurfelRun> runs) {
    for (const SurfelRun& run : runs) {
        Resident& chunk = chunks_[run.chunk];
        chunk.under_way -= static_cast<std::uint32_t>(run.slots.size());
        if (chunk.slots.size() == run.first_block) {
            put(run.surfels, run.slots);
            chunk.slots.insert(chunk.slots.end(), run.slots.begin(), run.slots.end());
        } else {  // what it goes on from has been let go of since
            free_.insert(free_.end(), run.slots.begin(), run.slots.end());
        }
    }
}

void SurfelCache::note(std::span<const ChunkSelection> selection) {
    for (const ChunkSelection& wanted : selection) {
        chunks_[wanted.chunk].used_at = frames_;
        chunks_[wanted.chunk].wanted = blocks_of(wanted.count);
    }
}

}  // namespace glowworm
