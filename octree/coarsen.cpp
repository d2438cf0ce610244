#include "octree/coarsen.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

#include "octree/extract.h"
#include "octree/filter.h"
#include "octree/lobe.h"
#include "octree/pack.h"

namespace glowworm {
namespace {

Vec3d vec3_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

Vec3d patch_corner(std::uint32_t packed, const Vec3d& cell_min, double edge) {
    const Vec3d steps{static_cast<double>(packed & 0xff), static_cast<double>(packed >> 8 & 0xff),
                      static_cast<double>(packed >> 16 & 0xff)};
    return cell_min + steps * (edge / 255.0);
}

void add_lobe(const Lobe& lobe, const Vec3d& cell_min, double edge, LeafSums& sums) {
    LobeSample sample;
    sample.position = vec3_of(lobe.position);
    sample.ndf = vec3_of(lobe.ndf);
    sample.albedo = vec3_of(lobe.albedo);
    sample.emission = vec3_cast<double>(unpack_rgb9e5(lobe.emission));
    sample.area = lobe.area;
    sample.surfels = lobe.area / (static_cast<double>(lobe.spacing) * lobe.spacing);
    sample.plane_sigma = lobe.plane_sigma;
    sample.light = lobe.light;
    sums.add_box(sample, patch_corner(lobe.patch_min, cell_min, edge),
                 patch_corner(lobe.patch_max, cell_min, edge));
}

}  // namespace

Octree coarsen(const OctreeView& octree, std::uint32_t depth) {
    Octree out;
    out.grid = octree.grid;
    out.grid.depth = std::min(depth, octree.grid.depth);
    out.bounds_min = octree.bounds_min;
    out.bounds_max = octree.bounds_max;
    out.sample_count = octree.sample_count;
    out.dropped_count = octree.dropped_count;
    out.stations.assign(octree.stations.begin(), octree.stations.end());
    out.area_lights.assign(octree.area_lights.begin(), octree.area_lights.end());
    out.names = octree.names;
    out.provenance = octree.provenance;
    if (depth >= octree.grid.depth) {
        out.levels.assign(octree.levels.begin(), octree.levels.end());
        out.nodes.assign(octree.nodes.begin(), octree.nodes.end());
        out.attributes.assign(octree.attributes.begin(), octree.attributes.end());
        out.lobes.assign(octree.lobes.begin(), octree.lobes.end());
        return out;
    }

    const std::vector<std::uint64_t> fine = codes_of_level(octree, octree.grid.depth);
    const std::uint32_t shift = 3 * (octree.grid.depth - depth);
    std::vector<std::uint64_t> coarse;
    std::vector<std::size_t> starts;  // of each coarse leaf among the fine ones
    for (std::size_t i = 0; i < fine.size(); ++i) {
        if (!coarse.empty() && coarse.back() == fine[i] >> shift) continue;
        coarse.push_back(fine[i] >> shift);
        starts.push_back(i);
    }
    starts.push_back(fine.size());

    struct Joined {
        std::array<Lobe, kMaxLobes> lobes;
    };
    std::vector<Joined> joined(coarse.size());
    std::vector<std::uint8_t> counts(coarse.size());
    const std::uint32_t first_leaf = octree.levels[octree.grid.depth].first_node;
    const double fine_edge = octree.grid.voxel_size();
    tbb::parallel_for(std::size_t{0}, coarse.size(), [&](std::size_t c) {
        LeafSums sums;
        sums.begin(out.grid.cell_min(morton_decode(coarse[c]), depth), out.grid.voxel_size());
        for (std::size_t i = starts[c]; i < starts[c + 1]; ++i) {
            const Node leaf = octree.nodes[first_leaf + i];
            const Vec3d corner = octree.grid.cell_min(morton_decode(fine[i]), octree.grid.depth);
            for (std::uint32_t l = 0; l < leaf.mask >> 8; ++l) {
                add_lobe(octree.lobes[leaf.first + l], corner, fine_edge, sums);
            }
        }
        counts[c] = static_cast<std::uint8_t>(sums.finish(joined[c].lobes));
    });
    for (std::size_t c = 0; c < coarse.size(); ++c) {
        out.lobes.insert(out.lobes.end(), joined[c].lobes.begin(),
                         joined[c].lobes.begin() + counts[c]);
    }

    NodeTree tree = build_nodes(out.grid, coarse, counts, out.lobes);
    out.levels = std::move(tree.levels);
    out.nodes = std::move(tree.nodes);
    out.attributes = std::move(tree.attributes);
    return out;
}

}  // namespace glowworm
