#include <algorithm>
#include <bit>
#include <utility>

#include "octree/chunk.h"

namespace glowworm {
namespace {

/// Levels that two codes of level 21 share.
std::uint32_t shared_levels(std::uint64_t a, std::uint64_t b) {
    return static_cast<std::uint32_t>(std::countl_zero((a ^ b) << 1 | 1)) / 3;
}

/// Cuts cells into chunks.
class Chunker {
  public:
    explicit Chunker(std::span<const CodeIndex> order) : order_(order) {}

    std::vector<SurfelRange> cut() {
        const Part all = part(0, order_.size());
        if (fits(all)) {
            add(all);
        } else {
            cut_cell(all, 0);
        }
        return std::move(chunks_);
    }

  private:
    struct Part {
        SurfelRange range;
        std::uint32_t needed_level;  ///< of the box; not looked at where there are too many surfels
    };

    Part part(std::uint64_t begin, std::uint64_t end) const {
        const SurfelRange range{begin, end};
        if (range.size() > kMaxChunkSurfels) return {range, 0};
        return {range, needed_box_level(order_.subspan(begin, range.size()))};
    }

    bool fits(const Part& part) const {
        const auto [begin, end] = part.range;
        return begin == end ||
               (end - begin <= kMaxChunkSurfels &&
                part.needed_level <= box_level_of(order_[begin].code, order_[end - 1].code));
    }

    void add(const Part& part) {
        if (part.range.size() > 0) chunks_.push_back(part.range);
    }

    void cut_cell(const Part& cell, std::uint32_t level) {
        const auto [begin, end] = cell.range;
        if (level == kMortonLevels) {
            for (std::uint64_t at = begin; at < end; at += kMaxChunkSurfels)
                chunks_.push_back({at, std::min(end, at + kMaxChunkSurfels)});
            return;
        }
        Part group{{begin, begin}, 0};
        for (std::uint64_t octant = 0, next = begin; octant < 8; ++octant) {
            const auto past = std::partition_point(
                order_.begin() + static_cast<std::ptrdiff_t>(next),
                order_.begin() + static_cast<std::ptrdiff_t>(end), [&](const CodeIndex& entry) {
                    return (code_at_level(entry.code, level + 1) & 7) <= octant;
                });
            const Part child = part(next, static_cast<std::uint64_t>(past - order_.begin()));
            next = child.range.end;
            const Part both{{group.range.begin, next},
                            std::max(group.needed_level, child.needed_level)};
            if (!fits(child)) {
                add(group);
                cut_cell(child, level + 1);
                group = {{next, next}, 0};
            } else if (!fits(both)) {
                add(group);
                group = child;
            } else {
                group = both;
            }
        }
        add(group);
    }

    std::span<const CodeIndex> order_;
    std::vector<SurfelRange> chunks_;
};

}  // namespace

std::uint32_t box_level_of(std::uint64_t first, std::uint64_t last) {
    return std::min(shared_levels(first, last), kMaxChunkLevel);
}

std::uint32_t needed_box_level(std::span<const CodeIndex> codes) {
    std::uint32_t densest = 0;  // levels that as many points share as may not
    for (std::size_t i = 0; i + kDensePoints <= codes.size(); ++i)
        densest = std::max(densest, shared_levels(codes[i].code, codes[i + kDensePoints - 1].code));
    return densest < kDenseLevels ? 0 : std::min(densest - kDenseLevels + 1, kFinestNeededLevel);
}

std::vector<SurfelRange> split_into_chunks(std::span<const CodeIndex> order) {
    return Chunker(order).cut();
}

}  // namespace glowworm
