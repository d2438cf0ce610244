#include "octree/voxelize.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

namespace glowworm {
namespace {

constexpr std::size_t kBlock = 16384;  ///< surfels a task sweeps

struct DiscPoint {
    double u, v;  ///< in disc radii
};

constexpr std::uint32_t pieces_of(std::uint32_t rings) {
    return 1 + 3 * rings * (rings + 1);
}

/// Pieces of equal area: one in the middle, then rings of 6, 12, 18, ... each at the radius that
/// halves its ring's area. Built from square roots alone, so the same on every host.
std::vector<DiscPoint> disc_pattern(std::uint32_t rings) {
    constexpr double kHalfRoot3 = 0.5 * std::numbers::sqrt3;
    constexpr DiscPoint kHexagon[7] = {{1.0, 0.0},  {0.5, kHalfRoot3},   {-0.5, kHalfRoot3},
                                       {-1.0, 0.0}, {-0.5, -kHalfRoot3}, {0.5, -kHalfRoot3},
                                       {1.0, 0.0}};
    const double pieces = pieces_of(rings);
    std::vector<DiscPoint> points{{0.0, 0.0}};
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
        const double radius = std::sqrt((pieces_of(ring - 1) + 3.0 * ring) / pieces);
        for (std::uint32_t side = 0; side < 6; ++side) {
            for (std::uint32_t step = 0; step < ring; ++step) {
                const double t = static_cast<double>(step) / ring;
                const DiscPoint a = kHexagon[side], b = kHexagon[side + 1];
                const double u = a.u + (b.u - a.u) * t, v = a.v + (b.v - a.v) * t;
                const double scale = radius / std::sqrt(u * u + v * v);
                points.push_back({u * scale, v * scale});
            }
        }
    }
    return points;
}

const std::vector<DiscPoint>& pattern_of(std::uint32_t rings) {
    static const auto patterns = [] {
        std::array<std::vector<DiscPoint>, kMaxSplatRings + 1> all;
        for (std::uint32_t i = 0; i <= kMaxSplatRings; ++i)
            all[i] = disc_pattern(i);
        return all;
    }();
    return patterns[rings];
}

/// Places a surfel's pieces and says which leaf each falls into.
class Splatter {
  public:
    Splatter(std::span<const Surfel> surfels, const Grid& grid)
        : surfels_(surfels),
          grid_(grid),
          voxel_(grid.voxel_size()),
          cube_max_(vec3_cast<double>(grid.cube_min) +
                    Vec3d{1.0, 1.0, 1.0} * static_cast<double>(grid.cube_edge)) {}

    const Surfel& surfel(std::uint32_t index) const { return surfels_[index]; }
    void expect(std::uint32_t index) const { prefetch(&surfels_[index]); }
    Splat splat(std::uint32_t index) const { return splat_of(surfels_[index], voxel_); }

    /// What sticks out of the root cube is moved to its side: area is conserved.
    Vec3d place(const Surfel& surfel, const Splat& splat, std::uint32_t piece) const {
        const Vec3d p = piece_position(surfel, splat, piece);
        return component_max(vec3_cast<double>(grid_.cube_min), component_min(cube_max_, p));
    }
    std::uint64_t leaf_of(const Vec3d& position) const {
        return code_at_level(grid_.code_of(position), grid_.depth);
    }
    LobeSample sample(const Surfel& surfel, const Splat& splat, const Vec3d& position) const {
        const double share = 1.0 / splat.pieces;
        return {position,
                vec3_cast<double>(surfel.normal) * static_cast<double>(surfel.ndf_length),
                vec3_cast<double>(surfel.albedo),
                vec3_cast<double>(surfel.emission),
                splat.area * share,
                share,
                0.0,
                surfel.light};
    }

  private:
    std::span<const Surfel> surfels_;
    const Grid& grid_;
    double voxel_;
    Vec3d cube_max_;
};

/// Pieces that fell into another leaf of `tile` than their surfel's own: that leaf's code, the
/// surfel, the piece.
std::vector<CodeIndex> collect_strays(const Splatter& splatter, std::span<const CodeIndex> order,
                                      const Grid& grid, const OctreeCell& tile) {
    const std::uint32_t tile_shift = 3 * (grid.depth - tile.level);
    const std::size_t blocks = (order.size() + kBlock - 1) / kBlock;
    std::vector<std::vector<CodeIndex>> found(blocks);
    tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
        const std::size_t end = std::min(order.size(), (block + 1) * kBlock);
        for (std::size_t i = block * kBlock; i < end; ++i) {
            if (i + kPrefetchAhead < end) splatter.expect(order[i + kPrefetchAhead].index);
            const Splat splat = splatter.splat(order[i].index);
            if (splat.pieces == 1) continue;
            const Surfel& surfel = splatter.surfel(order[i].index);
            const std::uint64_t own = code_at_level(order[i].code, grid.depth);
            for (std::uint32_t piece = 1; piece < splat.pieces; ++piece) {
                const std::uint64_t leaf = splatter.leaf_of(splatter.place(surfel, splat, piece));
                if (leaf != own && leaf >> tile_shift == tile.code)
                    found[block].push_back({leaf, order[i].index, piece});
            }
        }
    });

    std::size_t total = 0;
    for (const auto& part : found)
        total += part.size();
    std::vector<CodeIndex> strays;
    strays.reserve(total);
    for (auto& part : found) {
        strays.insert(strays.end(), part.begin(), part.end());
        std::vector<CodeIndex>().swap(part);
    }
    radix_sort(strays);
    return strays;
}

/// Sweeps one run of whole leaves: surfels and strays side by side, both in Morton order.
Leaves sweep(const Splatter& splatter, std::span<const CodeIndex> order,
             std::span<const CodeIndex> strays, const Grid& grid) {
    constexpr std::uint64_t kNone = std::numeric_limits<std::uint64_t>::max();
    Leaves out;
    LeafSums leaf;
    std::array<Lobe, kMaxLobes> lobes;
    const std::uint32_t depth = grid.depth;
    const double voxel = grid.voxel_size();

    std::size_t i = 0, s = 0;
    while (i < order.size() || s < strays.size()) {
        const std::uint64_t own = i < order.size() ? code_at_level(order[i].code, depth) : kNone;
        const std::uint64_t code = std::min(own, s < strays.size() ? strays[s].code : kNone);
        leaf.begin(grid.cell_min(morton_decode(code), depth), voxel);
        for (; i < order.size() && code_at_level(order[i].code, depth) == code; ++i) {
            if (i + kPrefetchAhead < order.size()) splatter.expect(order[i + kPrefetchAhead].index);
            const Surfel& surfel = splatter.surfel(order[i].index);
            const Splat splat = splatter.splat(order[i].index);
            for (std::uint32_t piece = 0; piece < splat.pieces; ++piece) {
                const Vec3d p = splatter.place(surfel, splat, piece);
                if (piece > 0 && splatter.leaf_of(p) != code) continue;
                leaf.add(splatter.sample(surfel, splat, p));
            }
        }
        for (; s < strays.size() && strays[s].code == code; ++s) {
            const Surfel& surfel = splatter.surfel(strays[s].index);
            const Splat splat = splatter.splat(strays[s].index);
            leaf.add(splatter.sample(surfel, splat, splatter.place(surfel, splat, strays[s].part)));
        }
        const std::size_t count = leaf.finish(lobes);
        out.codes.push_back(code);
        out.lobe_counts.push_back(static_cast<std::uint8_t>(count));
        out.lobes.insert(out.lobes.end(), lobes.begin(), lobes.begin() + static_cast<int>(count));
    }
    return out;
}

template <typename T>
void append(std::vector<T>& to, std::vector<T>& from) {
    to.insert(to.end(), from.begin(), from.end());
    std::vector<T>().swap(from);
}

}  // namespace

Splat splat_of(const Surfel& surfel, double voxel) {
    constexpr double kWiden = 1.5;  // at one sample a voxel face; light needs no more than 2
    const double radius = surfel.radius;
    Splat splat;
    splat.area = std::numbers::pi * radius * radius;
    const double side = radius / std::numbers::inv_sqrtpi;  // sqrt(area)
    splat.radius = radius * std::clamp(kWiden * side / voxel, 1.0, 2.0);
    // Pieces are sqrt(pi R² / n) apart; a quarter of a voxel at most, or leaves that no sample of a
    // random cloud falls into would be holes: 1 in 70 at 4 samples a face.
    const double needed = 16.0 * std::numbers::pi * splat.radius * splat.radius / (voxel * voxel);
    while (splat.pieces < needed && splat.rings < kMaxSplatRings) {
        splat.pieces = pieces_of(++splat.rings);
    }
    return splat;
}

Vec3d piece_position(const Surfel& surfel, const Splat& splat, std::uint32_t piece) {
    const Vec3d position = vec3_cast<double>(surfel.position);
    if (piece == 0) return position;
    // A frame without branches (Duff et al. 2017, Building an Orthonormal Basis, Revisited).
    const Vec3d n = vec3_cast<double>(surfel.normal);
    const double sign = n.z < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    const Vec3d tangent{1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    const Vec3d bitangent{b, sign + n.y * n.y * a, -n.y};
    const DiscPoint at = pattern_of(splat.rings)[piece];
    return position + tangent * (at.u * splat.radius) + bitangent * (at.v * splat.radius);
}

std::span<const CodeIndex> entries_in(std::span<const CodeIndex> order, const OctreeCell& tile) {
    const auto before = [](const CodeIndex& entry, std::uint64_t code) {
        return entry.code < code;
    };
    const auto begin = std::lower_bound(order.begin(), order.end(), tile.first_code(), before);
    return {begin, std::lower_bound(begin, order.end(), tile.end_code(), before)};
}

Leaves voxelize(std::span<const Surfel> surfels, std::span<const CodeIndex> all, const Grid& grid,
                double largest_radius, const OctreeCell& tile) {
    const Splatter splatter(surfels, grid);
    Surfel largest;
    largest.radius = static_cast<float>(largest_radius);
    std::vector<CodeIndex> strays;
    if (splat_of(largest, grid.voxel_size()).pieces > 1) {
        strays = collect_strays(splatter, all, grid, tile);
    }
    const std::span<const CodeIndex> order = entries_in(all, tile);

    // Cuts between leaves, then between the strays at the same codes.
    std::vector<std::size_t> cuts{0};
    while (cuts.back() < order.size()) {
        std::size_t cut = std::min(order.size(), cuts.back() + kBlock);
        while (cut < order.size() && code_at_level(order[cut].code, grid.depth) ==
                                         code_at_level(order[cut - 1].code, grid.depth)) {
            ++cut;
        }
        cuts.push_back(cut);
    }
    if (order.empty()) cuts.push_back(0);  // a tile may have nothing but strays
    std::vector<std::size_t> stray_cuts(cuts.size(), strays.size());
    stray_cuts[0] = 0;
    for (std::size_t c = 1; c + 1 < cuts.size(); ++c) {
        const std::uint64_t code = code_at_level(order[cuts[c]].code, grid.depth);
        stray_cuts[c] = static_cast<std::size_t>(
            std::lower_bound(strays.begin(), strays.end(), code,
                             [](const CodeIndex& e, std::uint64_t v) { return e.code < v; }) -
            strays.begin());
    }

    std::vector<Leaves> parts(cuts.size() - 1);
    tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t b) {
        parts[b] = sweep(
            splatter, order.subspan(cuts[b], cuts[b + 1] - cuts[b]),
            std::span(strays).subspan(stray_cuts[b], stray_cuts[b + 1] - stray_cuts[b]), grid);
    });

    Leaves leaves;
    std::size_t leaf_total = 0, lobe_total = 0;
    for (const Leaves& part : parts) {
        leaf_total += part.codes.size();
        lobe_total += part.lobes.size();
    }
    leaves.codes.reserve(leaf_total);
    leaves.lobe_counts.reserve(leaf_total);
    leaves.lobes.reserve(lobe_total);
    for (Leaves& part : parts) {
        append(leaves.codes, part.codes);
        append(leaves.lobe_counts, part.lobe_counts);
        append(leaves.lobes, part.lobes);
    }
    return leaves;
}

}  // namespace glowworm
