#include "octree/extract.h"

#include <algorithm>
#include <string>

#include "octree/chunk.h"
#include "octree/error.h"
#include "octree/filter.h"

namespace glowworm {
namespace {

void require_level(const OctreeView& octree, std::uint32_t level) {
    if (level <= octree.grid.depth) return;
    throw Error(ExitCode::kUsage, "there is no level " + std::to_string(level) +
                                      ": the octree's leaves are at level " +
                                      std::to_string(octree.grid.depth));
}

void cut_lobes(const OctreeView& octree, const Box& box, Octree& out) {
    const std::vector<std::uint64_t> codes = codes_of_level(octree, octree.grid.depth);
    const std::uint32_t first = octree.levels[octree.grid.depth].first_node;
    std::vector<std::uint64_t> kept;
    std::vector<std::uint8_t> counts;
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const Node leaf = octree.nodes[first + i];
        std::uint8_t count = 0;
        for (const Lobe& lobe : octree.lobes.subspan(leaf.first, leaf.mask >> 8)) {
            if (!box.holds(to_vec3(lobe.position))) continue;
            out.lobes.push_back(lobe);
            ++count;
        }
        if (count == 0) continue;
        kept.push_back(codes[i]);
        counts.push_back(count);
    }
    if (kept.empty()) {
        throw Error(ExitCode::kDegenerate,
                    "the box holds no surface; `glowworm info` says where the "
                    "octree's bounds are");
    }
    NodeTree tree = build_nodes(octree.grid, kept, counts, out.lobes);
    out.levels = std::move(tree.levels);
    out.nodes = std::move(tree.nodes);
    out.attributes = std::move(tree.attributes);
}

void cut_points(const OctreeView& octree, const Box& box, Octree& out) {
    for (const Chunk& chunk : octree.chunks) {
        const std::size_t first = out.surfels.size();
        for (const PackedSurfel& packed : octree.surfels.subspan(chunk.first, chunk.count)) {
            const Vec3f p = unpack_surfel(chunk, packed).position;
            if (!box.holds(p)) continue;
            const bool any = !out.surfels.empty();
            out.bounds_min = any ? component_min(out.bounds_min, p) : p;
            out.bounds_max = any ? component_max(out.bounds_max, p) : p;
            out.surfels.push_back(packed);
        }
        if (out.surfels.size() == first) continue;
        Chunk part = chunk;
        part.first = static_cast<std::uint32_t>(first);
        part.count = static_cast<std::uint32_t>(out.surfels.size() - first);
        out.chunks.push_back(part);
    }
    out.sample_count = out.surfels.size();
}

}  // namespace

std::vector<std::uint64_t> codes_of_level(const OctreeView& octree, std::uint32_t level) {
    std::vector<std::uint64_t> codes{0};
    for (std::uint32_t l = 0; l < level; ++l) {
        std::vector<std::uint64_t> next;
        next.reserve(octree.levels[l + 1].node_count);
        for (std::size_t i = 0; i < codes.size(); ++i) {
            const std::uint32_t mask = octree.nodes[octree.levels[l].first_node + i].mask;
            for (std::uint32_t octant = 0; octant < 8; ++octant) {
                if (mask >> octant & 1u) next.push_back(codes[i] << 3 | octant);
            }
        }
        codes = std::move(next);
    }
    return codes;
}

std::vector<Voxel> extract_level(const OctreeView& octree, std::uint32_t level) {
    require_level(octree, level);
    const std::vector<std::uint64_t> codes = codes_of_level(octree, level);
    const std::uint32_t first = octree.levels[level].first_node;
    const double half = 0.5 * octree.grid.cell_edge(level);
    std::vector<Voxel> voxels;
    voxels.reserve(codes.size());
    for (std::size_t i = 0; i < codes.size(); ++i) {
        const NodeAttributes& a = octree.attributes[first + i];
        const Vec3d corner = octree.grid.cell_min(morton_decode(codes[i]), level);
        voxels.push_back({vec3_cast<float>(corner + Vec3d{half, half, half}),
                          a.opacity,
                          a.area,
                          to_vec3(a.ndf),
                          {a.albedo[0], a.albedo[1], a.albedo[2]}});
    }
    return voxels;
}

Octree cut_box(const OctreeView& octree, const Box& box) {
    Octree out;
    out.grid = octree.grid;
    cut_lobes(octree, box, out);
    cut_points(octree, box, out);
    out.stations.assign(octree.stations.begin(), octree.stations.end());
    out.area_lights.assign(octree.area_lights.begin(), octree.area_lights.end());
    out.names = octree.names;
    out.provenance = octree.provenance;
    return out;
}

}  // namespace glowworm
