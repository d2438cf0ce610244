#include "octree/chunk.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <tuple>

#include "octree/pack.h"

namespace glowworm {
namespace {

constexpr std::uint32_t kCodeLevels = 16;  ///< levels of a quantised position

/// Levels that two codes of level 21 share.
std::uint32_t shared_levels(std::uint64_t a, std::uint64_t b) {
    return static_cast<std::uint32_t>(std::countl_zero((a ^ b) << 1 | 1)) / 3;
}

/// Level of the smallest cell that may be the box of codes from `first` to `last`.
std::uint32_t box_level_of(std::uint64_t first, std::uint64_t last) {
    return std::min(shared_levels(first, last), kMaxChunkLevel);
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

struct Quantised {
    std::uint32_t x, y, z;
};

Quantised position_of(const PackedSurfel& s) {
    return {s.position_xy & 0xffff, s.position_xy >> 16, s.position_z_radius & 0xffff};
}

std::uint64_t code_of(const PackedSurfel& surfel) {
    const Quantised q = position_of(surfel);
    return morton_encode({q.x, q.y, q.z});
}

/// Levels that two codes share, 0..16.
std::uint32_t common_levels(std::uint64_t a, std::uint64_t b) {
    const int leading = std::countl_zero((a ^ b) << 16 | 0x8000);
    return static_cast<std::uint32_t>(leading) / 3;
}

/// Squared distance of a point from the centre of its cell at `level`, in quantisation steps.
std::uint64_t centre_distance(std::uint64_t code, std::uint32_t level) {
    const CellIndex q = morton_decode(code);
    const std::uint32_t bits = kCodeLevels - level;
    const auto axis = [&](std::uint32_t v) {
        const std::int64_t twice =
            2 * static_cast<std::int64_t>(v & ((1u << bits) - 1)) + 1 - (std::int64_t{1} << bits);
        return static_cast<std::uint64_t>(twice * twice);
    };
    return axis(q.x) + axis(q.y) + axis(q.z);
}

/// Level from which each point is shown: a knockout over the tree of common prefixes, in one sweep.
std::vector<std::uint8_t> first_levels(std::span<const std::uint64_t> codes) {
    struct Standing {
        std::uint32_t point;
        std::uint32_t shared;  ///< levels shared with the one below it on the stack
    };
    std::vector<std::uint8_t> levels(codes.size(), 0);
    std::vector<Standing> stack;
    const auto meet = [&] {
        const Standing challenger = stack.back();
        stack.pop_back();
        Standing& holder = stack.back();
        const std::uint32_t cell = challenger.shared;
        const bool holds = centre_distance(codes[holder.point], cell) <=
                           centre_distance(codes[challenger.point], cell);
        levels[holds ? challenger.point : holder.point] = static_cast<std::uint8_t>(cell + 1);
        if (!holds) holder.point = challenger.point;
    };
    for (std::uint32_t i = 0; i < codes.size(); ++i) {
        const std::uint32_t shared = i == 0 ? 0 : common_levels(codes[i - 1], codes[i]);
        while (stack.size() > 1 && stack.back().shared > shared)
            meet();
        stack.push_back({i, shared});
    }
    while (stack.size() > 1)
        meet();
    return levels;
}

std::uint32_t reverse_bits(std::uint32_t v, int bits) {
    v = (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
    v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
    v = (v >> 4 & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4;
    v = (v >> 8 & 0x00ff00ffu) | (v & 0x00ff00ffu) << 8;
    v = v >> 16 | v << 16;
    return bits == 0 ? 0 : v >> (32 - bits);
}

struct Coded {
    std::uint64_t code;
    PackedSurfel surfel;
};

bool before(const Coded& a, const Coded& b) {
    const auto rest = [](const PackedSurfel& s) {
        return std::tie(s.position_z_radius, s.normal, s.albedo_ndf, s.station_light);
    };
    return a.code != b.code ? a.code < b.code : rest(a.surfel) < rest(b.surfel);
}

/// Sorts what is nearly sorted: only runs that share their first `levels` levels can be out of
/// order.
void sort_runs(std::vector<Coded>& coded, std::uint32_t levels) {
    const int shift = 3 * static_cast<int>(kCodeLevels - levels);
    for (auto run = coded.begin(); run != coded.end();) {
        auto end = run + 1;
        while (end != coded.end() && end->code >> shift == run->code >> shift)
            ++end;
        if (end - run > 1) std::sort(run, end, before);
        run = end;
    }
}

Chunk describe(std::span<const PackedSurfel> surfels, const Grid& grid, const CellIndex& box,
               std::uint32_t box_level) {
    const Vec3f corner = vec3_cast<float>(grid.cell_min(box, box_level));
    Chunk chunk{{corner.x, corner.y, corner.z}, grid.cell_edge(box_level), 0, 0, 0.0f, 0.0f};
    chunk.count = static_cast<std::uint32_t>(surfels.size());
    double area = 0.0;
    for (const PackedSurfel& s : surfels) {
        const float radius = unpack_half(static_cast<std::uint16_t>(s.position_z_radius >> 16));
        area += std::numbers::pi * radius * radius;
        chunk.max_radius = std::max(chunk.max_radius, radius);
    }
    chunk.spacing = static_cast<float>(std::sqrt(area / static_cast<double>(surfels.size())));
    return chunk;
}

Chunk arrange(std::vector<Coded>& coded, std::span<PackedSurfel> out, const Grid& grid,
              const CellIndex& box, std::uint32_t box_level) {
    std::vector<std::uint64_t> codes(coded.size());
    for (std::size_t i = 0; i < coded.size(); ++i)
        codes[i] = coded[i].code;
    const std::vector<std::uint32_t> order = detail_order(codes);
    for (std::size_t i = 0; i < order.size(); ++i)
        out[i] = coded[order[i]].surfel;
    return describe(out, grid, box, box_level);
}

}  // namespace

std::uint32_t needed_box_level(std::span<const CodeIndex> codes) {
    std::uint32_t densest = 0;  // levels that as many points share as may not
    for (std::size_t i = 0; i + kDensePoints <= codes.size(); ++i)
        densest = std::max(densest, shared_levels(codes[i].code, codes[i + kDensePoints - 1].code));
    return densest < kDenseLevels ? 0 : std::min(densest - kDenseLevels + 1, kFinestNeededLevel);
}

std::vector<SurfelRange> split_into_chunks(std::span<const CodeIndex> order) {
    return Chunker(order).cut();
}

std::vector<std::uint32_t> detail_order(std::span<const std::uint64_t> codes) {
    const std::vector<std::uint8_t> levels = first_levels(codes);

    std::array<std::uint32_t, kCodeLevels + 3> starts{};
    for (const std::uint8_t level : levels)
        ++starts[level + 1u];
    for (std::size_t l = 1; l < starts.size(); ++l)
        starts[l] += starts[l - 1];
    std::vector<std::uint32_t> by_level(codes.size());
    auto next = starts;
    for (std::uint32_t i = 0; i < codes.size(); ++i)
        by_level[next[levels[i]]++] = i;

    std::vector<std::uint32_t> order;
    order.reserve(codes.size());
    for (std::size_t l = 0; l + 1 < starts.size(); ++l) {
        const std::uint32_t count = starts[l + 1] - starts[l];
        if (count == 0) continue;
        const int bits = std::bit_width(count - 1);
        for (std::uint32_t i = 0; i < 1u << bits; ++i) {
            const std::uint32_t place = reverse_bits(i, bits);
            if (place < count) order.push_back(by_level[starts[l] + place]);
        }
    }
    return order;
}

Chunk arrange_chunk(std::span<PackedSurfel> surfels, const Grid& grid, const CellIndex& box,
                    std::uint32_t box_level) {
    std::vector<Coded> coded(surfels.size());
    for (std::size_t i = 0; i < surfels.size(); ++i)
        coded[i] = {code_of(surfels[i]), surfels[i]};
    std::sort(coded.begin(), coded.end(), before);
    return arrange(coded, surfels, grid, box, box_level);
}

Chunk pack_chunk(std::span<const Surfel> surfels, std::span<const CodeIndex> range,
                 const Grid& grid, std::span<PackedSurfel> out) {
    const std::uint32_t level = box_level_of(range.front().code, range.back().code);
    const CellIndex box = morton_decode(code_at_level(range.front().code, level));
    // From cells of level 21 to steps of level + 16: a power of two, exact.
    const double steps =
        std::ldexp(1.0, static_cast<int>(level + kCodeLevels) - static_cast<int>(kMortonLevels));

    std::vector<Coded> coded(range.size());
    for (std::size_t i = 0; i < range.size(); ++i) {
        if (i + kPrefetchAhead < range.size()) prefetch(&surfels[range[i + kPrefetchAhead].index]);
        const Surfel& s = surfels[range[i].index];
        const Vec3d at = grid.finest_coordinates(vec3_cast<double>(s.position)) * steps;
        const auto axis = [](double v, std::uint32_t cell) {
            return static_cast<std::uint32_t>(static_cast<std::uint64_t>(v) -
                                              (std::uint64_t{cell} << kCodeLevels));
        };
        const std::uint32_t x = axis(at.x, box.x), y = axis(at.y, box.y), z = axis(at.z, box.z);
        const auto ndf = static_cast<std::uint32_t>(round_to_int(s.ndf_length * 255.0f));
        coded[i] = {
            morton_encode({x, y, z}),
            {x | y << 16, z | std::uint32_t{pack_half(s.radius)} << 16, pack_octahedral(s.normal),
             pack_srgb8(s.albedo.x) | std::uint32_t{pack_srgb8(s.albedo.y)} << 8 |
                 std::uint32_t{pack_srgb8(s.albedo.z)} << 16 | ndf << 24,
             s.station | s.light << 16}};
    }
    sort_runs(coded, std::min(kCodeLevels, kMortonLevels - level));
    return arrange(coded, out, grid, box, level);
}

Surfel unpack_surfel(const Chunk& chunk, const PackedSurfel& packed) {
    const Quantised q = position_of(packed);
    const auto axis = [&](int i, std::uint32_t v) {
        return chunk.box_min[i] + (static_cast<float>(v) + 0.5f) / 65536.0f * chunk.box_edge;
    };
    Surfel s;
    s.position = {axis(0, q.x), axis(1, q.y), axis(2, q.z)};
    s.normal = unpack_octahedral(packed.normal);
    s.radius = unpack_half(static_cast<std::uint16_t>(packed.position_z_radius >> 16));
    s.ndf_length = static_cast<float>(packed.albedo_ndf >> 24) / 255.0f;
    s.albedo = {unpack_srgb8(static_cast<std::uint8_t>(packed.albedo_ndf)),
                unpack_srgb8(static_cast<std::uint8_t>(packed.albedo_ndf >> 8)),
                unpack_srgb8(static_cast<std::uint8_t>(packed.albedo_ndf >> 16))};
    s.station = packed.station_light & 0xffff;
    s.light = packed.station_light >> 16;
    return s;
}

}  // namespace glowworm
