// The rims' passes of SplatPass.
#include <bit>

#include "viewer/frame/splat_picture.h"

namespace glowworm {
namespace {

constexpr PixelBox kNowhere{0, 0, -1, -1};

}  // namespace

/// Whether there are any.
bool SplatPass::Picture::find_rims(const SplatTile& tile, gpu::SplatTopics& own) {
    const auto squares = (topics.view.width + RIM_TILE - 1) / RIM_TILE;
    bool any = false;
    for (int y = tile.top; y <= tile.bottom; ++y) {
        std::uint32_t bits = 0;
        for (int x = tile.left; x <= tile.right; ++x) {
            const auto at = static_cast<uint>(pixel(x, y));
            rims[at] = 0.0f;
            if (own.is_solid(at)) continue;
            rims[at] = own.find_rim({x, y}, weights[at] > 0 ? depths[at] : 0.0f);
            if (rims[at] == 0.0f) continue;
            bits |= 1u << (x - tile.left);
            rim_squares[static_cast<uint>(y) / RIM_TILE * squares +
                        static_cast<uint>(x) / RIM_TILE] = 1;
        }
        rim_bits[tile.index * kTile + static_cast<std::size_t>(y - tile.top)] = bits;
        any |= bits != 0;
    }
    return any;
}

void SplatPass::Picture::open_rims(const SplatTile& tile, gpu::SplatTopics& own,
                                   std::span<const TileBins> bins, SplatGroups<SplatShare>& sums) {
    const std::uint32_t* rows_bits = &rim_bits[tile.index * kTile];
    const auto for_each_rim = [&](const PixelBox& whole, const auto& visit) {
        const PixelBox box = tile.clipped(whole);
        if (box.empty()) return;
        const int first = box.low_x - tile.left, last = box.high_x - tile.left;
        const std::uint32_t columns_bits = (~0u << first) & (~0u >> (kTile - 1 - last));
        for (int y = box.low_y; y <= box.high_y; ++y) {
            for (std::uint32_t bits = rows_bits[y - tile.top] & columns_bits; bits != 0;
                 bits &= bits - 1)
                visit(tile.left + std::countr_zero(bits), y);
        }
    };
    const auto for_each_disc = [&](const auto& visit) {
        for (std::size_t i = 0; i < bins.size(); ++i) {
            for (const std::uint32_t index : bins[i].of(tile.index)) {
                const gpu::SplatDisc disc = parts[i].discs[index];
                for_each_rim(own.grown_box(disc.splat), [&](int x, int y) {
                    gpu::Floats depth, off;
                    own.splat_at(disc.splat, static_cast<float>(x) + 0.5f + gpu::Floats{},
                                 static_cast<float>(y) + 0.5f + gpu::Floats{}, depth, off);
                    if (depth[0] > 0.0f) visit(disc, depth[0], off[0], x, y);
                });
            }
        }
    };
    for_each_rim(tile.all(), [&](int x, int y) { depths[pixel(x, y)] = kFarthest; });
    for_each_disc([&](const gpu::SplatDisc& disc, float depth, float off, int x, int y) {
        float& nearest = depths[pixel(x, y)];
        const float most = own.reach_behind(rims[pixel(x, y)], depth, disc.splat.radius);
        if (off < most) nearest = std::min(nearest, depth);
    });
    for_each_rim(tile.all(), [&](int x, int y) {
        const auto at = static_cast<uint>(pixel(x, y));
        if (own.keeps_rim(at, {x, y})) depths[at] = rims[at];
    });
    for_each_disc([&](const gpu::SplatDisc& disc, float depth, float off, int x, int y) {
        const float behind = depth - depths[pixel(x, y)];
        const float most = own.reach_beside(rims[pixel(x, y)], behind, disc.splat.radius);
        if (behind > disc.splat.radius || off >= most) return;
        gpu::Floats weight{};
        weight[tile.lane(x)] = own.splat_weight(off + gpu::Floats{}, most)[0];
        add_to(sums[tile.group(x, y)],
               own.share_of_surface(
                   weight, disc.normal, own.surfel_albedo({.albedo_ndf = disc.albedo_ndf}),
                   own.surfel_ndf_length({.albedo_ndf = disc.albedo_ndf}), behind + gpu::Floats{}));
    });
}

void SplatPass::open_rims(std::span<gpu::vec4> surfaces, std::span<gpu::vec4> albedos) {
    Picture& p = *picture_;
    std::vector<char> opened(static_cast<std::size_t>(p.columns * p.rows));
    std::ranges::fill(p.rim_squares, 0u);
    p.for_each_tile([&](const SplatTile& tile, gpu::SplatTopics& own) {
        opened[tile.index] = p.find_rims(tile, own) ? 1 : 0;
    });
    if (std::ranges::count(opened, 1) == 0) return;

    std::vector<TileBins> bins;
    for (const SplatDiscs& part : std::span(p.parts).first(p.used)) {
        const auto near =
            std::make_unique_for_overwrite<PixelBox[]>(part.used.size() * SplatDiscs::kRun);
        tbb::parallel_for(std::size_t{0}, part.used.size(), [&](std::size_t run) {
            gpu::SplatTopics own = p.topics;
            for (std::size_t i = run * SplatDiscs::kRun;
                 i < run * SplatDiscs::kRun + part.used[run]; ++i) {
                near[i] = kNowhere;
                if (!own.may_close_gaps(part.boxes[i])) continue;
                const PixelBox box = own.grown_box(part.discs[i].splat);
                if (own.any_rim({box.low_x, box.low_y, box.high_x, box.high_y})) near[i] = box;
            }
        });
        bins.push_back(part.binned(near.get(), p.topics.view));
    }
    p.for_each_tile([&](const SplatTile& tile, gpu::SplatTopics& own) {
        if (opened[tile.index] == 0) return;
        SplatGroups<SplatShare> sums{};
        p.open_rims(tile, own, bins, sums);
        for (int y = tile.top; y <= tile.bottom; ++y) {
            std::uint32_t bits =
                p.rim_bits[tile.index * kTile + static_cast<std::size_t>(y - tile.top)];
            for (; bits != 0; bits &= bits - 1) {
                p.resolve(tile, own, sums, tile.left + std::countr_zero(bits), y, surfaces,
                          albedos);
            }
        }
    });
}

}  // namespace glowworm
