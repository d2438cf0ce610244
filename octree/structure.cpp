#include "octree/structure.h"

#include <algorithm>

namespace glowworm {
namespace {

bool levels_fit(const OctreeView& octree) {
    std::uint64_t next = 0;
    for (const Level& level : octree.levels) {
        if (level.first_node != next || level.node_count == 0) return false;
        next += level.node_count;
    }
    return octree.levels.size() == octree.grid.depth + std::size_t{1} &&
           next == octree.nodes.size() && octree.attributes.size() == octree.nodes.size() &&
           octree.levels[0].node_count == 1;
}

/// Codes of the leaves, or nothing where the links between the levels are broken.
std::vector<std::uint64_t> follow_levels(const OctreeView& octree, Sentences& sentences) {
    std::vector<std::uint64_t> codes{0};
    for (std::uint32_t level = 0; level < octree.grid.depth; ++level) {
        const Level here = octree.levels[level], below = octree.levels[level + 1];
        std::vector<std::uint64_t> next;
        next.reserve(below.node_count);
        std::uint64_t child = below.first_node;
        bool sound = codes.size() == here.node_count;
        for (std::size_t i = 0; sound && i < here.node_count; ++i) {
            const Node node = octree.nodes[here.first_node + i];
            sound = node.mask > 0 && node.mask <= 0xff && node.first == child;
            for (std::uint32_t octant = 0; sound && octant < 8; ++octant) {
                if (node.mask >> octant & 1u) next.push_back(codes[i] << 3 | octant);
            }
            child = below.first_node + next.size();
            sound = sound && next.size() <= below.node_count;
        }
        if (!sound || next.size() != below.node_count) {
            sentences.push_back("the nodes of level " + std::to_string(level) +
                                " do not have exactly the nodes of level " +
                                std::to_string(level + 1) + " as their children, in order");
            return {};
        }
        codes = std::move(next);
    }
    return codes;
}

bool leaves_fit(const OctreeView& octree, Sentences& sentences) {
    const Level leaves = octree.levels[octree.grid.depth];
    std::uint64_t next = 0;
    for (std::uint32_t i = 0; i < leaves.node_count; ++i) {
        const Node leaf = octree.nodes[leaves.first_node + i];
        const std::uint32_t count = leaf.mask >> 8;
        if ((leaf.mask & 0xff) != 0 || count < 1 || count > 3 || leaf.first != next) {
            sentences.push_back("leaf " + std::to_string(i) +
                                " does not have the next one to three lobes");
            return false;
        }
        next += count;
    }
    if (next == octree.lobes.size()) return true;
    sentences.push_back("the leaves have " + std::to_string(next) + " lobes together, the file " +
                        std::to_string(octree.lobes.size()));
    return false;
}

}  // namespace

std::vector<std::uint64_t> follow_tree(const OctreeView& octree, Sentences& sentences) {
    if (octree.grid.depth > kMaxDepth || !levels_fit(octree)) {
        sentences.push_back("the levels do not add up to the nodes");
        return {};
    }
    std::vector<std::uint64_t> codes = follow_levels(octree, sentences);
    if (codes.empty() || !leaves_fit(octree, sentences)) return {};
    return codes;
}

void check_ranges(const OctreeView& octree, Sentences& sentences) {
    std::uint64_t next = 0;
    bool consecutive = true;
    for (const Chunk& chunk : octree.chunks) {
        consecutive = consecutive && chunk.first == next && chunk.count > 0 &&
                      chunk.count <= kMaxChunkSurfels;
        next += chunk.count;
    }
    if (!consecutive || next != octree.surfels.size()) {
        sentences.push_back("the chunks do not hold every point once, in order");
    }
    const std::size_t stations = std::max<std::size_t>(1, octree.stations.size());
    const std::size_t lights = octree.area_lights.size();
    const auto surfels = octree.surfels;
    expect_all(sentences, surfels.size(), "point", "name a station that is not there",
               [&](std::size_t i) { return (surfels[i].station_light & 0xffff) >= stations; });
    expect_all(sentences, surfels.size(), "point", "name a light that is not there",
               [&](std::size_t i) { return surfels[i].station_light >> 16 > lights; });
    expect_all(sentences, octree.lobes.size(), "lobe", "name a light that is not there",
               [&](std::size_t i) { return octree.lobes[i].light > lights; });
    const auto name_outside = [&](const auto& record) {
        return std::uint64_t{record.name_offset} + record.name_bytes > octree.names.size();
    };
    expect_all(sentences, octree.stations.size(), "station", "have a name outside the names",
               [&](std::size_t i) { return name_outside(octree.stations[i]); });
    expect_all(sentences, lights, "area light", "have a name outside the names",
               [&](std::size_t i) { return name_outside(octree.area_lights[i]); });
    const std::uint64_t rays = octree.links_per_lobe;
    if (rays == 0 ? !octree.links.empty()
                  : octree.links.size() % rays != 0 ||
                        octree.links.size() / rays != octree.lobes.size()) {
        sentences.push_back("the links do not belong to the lobes");
    }
    expect_all(sentences, octree.links.size(), "link", "lead to a lobe that is not there",
               [&](std::size_t i) {
                   const std::uint32_t link = octree.links[i];
                   return link != kNoHit && link != kBuried && link >= octree.lobes.size();
               });
}

std::vector<std::string> check_structure(const OctreeView& octree) {
    Sentences sentences;
    follow_tree(octree, sentences);
    check_ranges(octree, sentences);
    return sentences;
}

}  // namespace glowworm
