#include "octree/check.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "octree/checksums.h"
#include "octree/chunk.h"
#include "octree/error.h"
#include "octree/rules.h"
#include "octree/vec3.h"

namespace glowworm {
namespace {

bool finite3(const float (&v)[3]) {
    return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

bool unit_interval3(const float (&v)[3]) {
    return std::all_of(v, v + 3, [](float c) { return c >= 0.0f && c <= 1.0f; });
}

/// At most 1, but for rounding.
bool ndf_length_fits(const float (&ndf)[3]) {
    return finite3(ndf) && ndf[0] * ndf[0] + ndf[1] * ndf[1] + ndf[2] * ndf[2] <= 1.0001f;
}

/// The cell's box grown by a little more than float rounding moves a mean.
bool inside_cell(const OctreeView& octree, const Lobe& lobe, std::uint64_t code) {
    const double edge = octree.grid.voxel_size();
    const Vec3d lower = octree.grid.cell_min(morton_decode(code), octree.grid.depth);
    for (int axis = 0; axis < 3; ++axis) {
        const double slack = 1e-3 * edge + 4e-7 * std::abs(lower[axis]);
        const double p = lobe.position[axis];
        if (!(p >= lower[axis] - slack && p <= lower[axis] + edge + slack)) return false;
    }
    return true;
}

bool patch_fits(const Lobe& lobe) {
    for (int shift = 0; shift < 24; shift += 8) {
        if ((lobe.patch_min >> shift & 0xff) > (lobe.patch_max >> shift & 0xff)) return false;
    }
    return lobe.patch_min >> 24 == 0 && lobe.patch_max >> 24 == 0;
}

void check_lobes(const OctreeView& octree, std::span<const std::uint64_t> codes,
                 Sentences& sentences) {
    const auto lobes = octree.lobes;
    const auto expect = [&](const char* failure, const auto& broken) {
        expect_all(sentences, lobes.size(), "lobe", failure,
                   [&](std::size_t i) { return broken(lobes[i]); });
    };
    expect("have no area",
           [](const Lobe& l) { return !(l.area > 0.0f) || !std::isfinite(l.area); });
    expect("have an NDF vector longer than 1",
           [](const Lobe& l) { return !ndf_length_fits(l.ndf); });
    expect("have an albedo outside 0 to 1",
           [](const Lobe& l) { return !unit_interval3(l.albedo); });
    expect("have an impossible spread or spacing", [&](const Lobe& l) {
        return !(l.plane_sigma >= 0.0f && std::isfinite(l.plane_sigma)) ||
               !(l.spacing > 0.0f && std::isfinite(l.spacing));
    });
    expect("have patch bounds the wrong way round", [](const Lobe& l) { return !patch_fits(l); });
    const Level leaves = octree.levels[octree.grid.depth];
    expect_all(sentences, codes.size(), "leaf node", "have a lobe outside their cell",
               [&](std::size_t i) {
                   const Node leaf = octree.nodes[leaves.first_node + i];
                   for (std::uint32_t l = 0; l < leaf.mask >> 8; ++l) {
                       if (!inside_cell(octree, lobes[leaf.first + l], codes[i])) return true;
                   }
                   return false;
               });
}

/// A node's area is its children's sum, a leaf's its lobes', but for float rounding.
bool area_adds_up(const OctreeView& octree, std::size_t index) {
    const Node node = octree.nodes[index];
    double sum = 0.0;
    if (index >= octree.levels[octree.grid.depth].first_node) {
        for (std::uint32_t l = 0; l < node.mask >> 8; ++l)
            sum += octree.lobes[node.first + l].area;
    } else {
        const auto children = static_cast<std::uint32_t>(std::popcount(node.mask & 0xff));
        for (std::uint32_t c = 0; c < children; ++c)
            sum += octree.attributes[node.first + c].area;
    }
    return std::abs(octree.attributes[index].area - sum) <= 1e-6 * sum;
}

void check_attributes(const OctreeView& octree, Sentences& sentences) {
    const auto expect = [&](const char* failure, const auto& broken) {
        expect_all(sentences, octree.nodes.size(), "node", failure, broken);
    };
    expect("have an opacity outside 0 to 1", [&](std::size_t i) {
        return !(octree.attributes[i].opacity >= 0.0f && octree.attributes[i].opacity <= 1.0f);
    });
    expect("have an NDF vector longer than 1",
           [&](std::size_t i) { return !ndf_length_fits(octree.attributes[i].ndf); });
    expect("have an albedo outside 0 to 1",
           [&](std::size_t i) { return !unit_interval3(octree.attributes[i].albedo); });
    expect("do not have the area of what is in them",
           [&](std::size_t i) { return !area_adds_up(octree, i); });
}

/// A chunk's box is a cell of the grid, to the bit.
bool chunk_is_placed(const OctreeView& octree, const Chunk& chunk) {
    const double ratio = octree.grid.cube_edge / chunk.box_edge;
    if (!(ratio >= 1.0 && ratio <= 1u << kMaxChunkLevel)) return false;
    const auto level = static_cast<std::uint32_t>(std::ilogb(ratio));
    CellIndex cell;
    std::uint32_t* axes[3] = {&cell.x, &cell.y, &cell.z};
    for (int axis = 0; axis < 3; ++axis) {
        const double at = (static_cast<double>(chunk.box_min[axis]) - octree.grid.cube_min[axis]) /
                          chunk.box_edge;
        if (!(at > -0.5 && at < static_cast<double>(1u << level))) return false;
        *axes[axis] = static_cast<std::uint32_t>(std::lround(at));
    }
    const Vec3f corner = vec3_cast<float>(octree.grid.cell_min(cell, level));
    return chunk.box_edge == octree.grid.cell_edge(level) && chunk.box_min[0] == corner.x &&
           chunk.box_min[1] == corner.y && chunk.box_min[2] == corner.z && chunk.spacing >= 0.0f &&
           std::isfinite(chunk.spacing) && chunk.max_radius >= 0.0f &&
           std::isfinite(chunk.max_radius);
}

/// Chunks, stations and lights are where they can be.
void check_placement(const OctreeView& octree, Sentences& sentences) {
    if (octree.sample_count != octree.surfels.size()) {
        sentences.push_back("the header counts " + std::to_string(octree.sample_count) +
                            " samples, there are " + std::to_string(octree.surfels.size()));
    }
    expect_all(sentences, octree.chunks.size(), "chunk", "have a box that is no cell of the octree",
               [&](std::size_t i) { return !chunk_is_placed(octree, octree.chunks[i]); });
    const auto finite = [](auto v) { return std::isfinite(v); };
    expect_all(sentences, octree.stations.size(), "station", "have an impossible pose",
               [&](std::size_t i) {
                   const StationRecord& s = octree.stations[i];
                   return !std::all_of(s.position, s.position + 3, finite) ||
                          !std::all_of(s.rotation, s.rotation + 4, finite);
               });
    expect_all(sentences, octree.area_lights.size(), "area light",
               "have an impossible place or radiance", [&](std::size_t i) {
                   const AreaLightRecord& a = octree.area_lights[i];
                   return !std::all_of(a.corners, a.corners + 12, finite) ||
                          !std::all_of(a.radiance, a.radiance + 3, finite);
               });
}

}  // namespace

std::vector<std::string> check_octree(const OctreeView& octree) {
    Sentences sentences;
    // Values are looked at through indices that the walk has shown to be inside.
    const std::vector<std::uint64_t> codes = follow_tree(octree, sentences);
    if (!codes.empty()) {
        check_lobes(octree, codes, sentences);
        check_attributes(octree, sentences);
    }
    check_ranges(octree, sentences);
    check_placement(octree, sentences);
    return sentences;
}

std::vector<std::string> check_octree_file(const std::filesystem::path& path) {
    try {
        const OctreeFile file = OctreeFile::open(path);
        Sentences sentences = check_checksums(file);
        const Sentences invariants = check_octree(file.view());
        sentences.insert(sentences.end(), invariants.begin(), invariants.end());
        file.require_intact();
        return sentences;
    } catch (const Error& error) {
        if (!is_octree_of_this_version(path)) throw;
        return {error.what()};
    }
}

}  // namespace glowworm
