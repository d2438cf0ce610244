#include "octree/chunk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "octree/pack.h"

namespace glowworm {
namespace {

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
