#include "octree/check.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "octree/error.h"
#include "octree/vec3.h"

namespace glowworm {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr std::size_t kNowhere = std::numeric_limits<std::size_t>::max();

using Sentences = std::vector<std::string>;

/// How often a rule is broken and where first.
struct Broken {
    std::size_t count = 0;
    std::size_t first = kNowhere;
};

/// Counts the indices in [0, count) for which `broken` holds.
template <typename Rule>
Broken find_broken(std::size_t count, const Rule& broken) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, count, kGrain), Broken{},
        [&](const auto& range, Broken sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                if (!broken(i)) continue;
                ++sum.count;
                sum.first = std::min(sum.first, i);
            }
            return sum;
        },
        [](const Broken& a, const Broken& b) {
            return Broken{a.count + b.count, std::min(a.first, b.first)};
        });
}

/// Adds a sentence such as "17 lobes have no finite position, the first is lobe 3".
template <typename Rule>
void expect_all(Sentences& sentences, std::size_t count, const char* noun, const char* failure,
                const Rule& broken) {
    const Broken found = find_broken(count, broken);
    if (found.count == 0) return;
    sentences.push_back(std::to_string(found.count) + " of " + std::to_string(count) + " " + noun +
                        "s " + failure + ", first at " + noun + " " + std::to_string(found.first));
}

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

/// Codes of the leaves of a tree whose every index stays inside, else nothing and a sentence.
std::vector<std::uint64_t> follow_tree(const OctreeView& octree, Sentences& sentences) {
    if (octree.grid.depth > kMaxDepth || !levels_fit(octree)) {
        sentences.push_back("the levels do not add up to the nodes");
        return {};
    }
    std::vector<std::uint64_t> codes = follow_levels(octree, sentences);
    if (codes.empty() || !leaves_fit(octree, sentences)) return {};
    return codes;
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
    expect_all(sentences, codes.size(), "leaf", "have a lobe outside their cell",
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

bool chunk_is_placed(const OctreeView& octree, const Chunk& chunk) {
    bool inside =
        finite3(chunk.box_min) && chunk.box_edge > 0.0f && chunk.box_edge <= octree.grid.cube_edge;
    for (int axis = 0; axis < 3; ++axis) {
        const float lower = octree.grid.cube_min[axis];
        const float slack = 1e-3f * octree.grid.cube_edge;
        inside = inside && chunk.box_min[axis] >= lower - slack &&
                 chunk.box_min[axis] <= lower + octree.grid.cube_edge + slack;
    }
    return inside && chunk.spacing >= 0.0f && std::isfinite(chunk.spacing) &&
           chunk.max_radius >= 0.0f && std::isfinite(chunk.max_radius);
}

/// Chunks, points, names, lights and links stay inside their sections.
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

/// Chunks, stations and lights are where they can be.
void check_placement(const OctreeView& octree, Sentences& sentences) {
    if (octree.sample_count != octree.surfels.size()) {
        sentences.push_back("the header counts " + std::to_string(octree.sample_count) +
                            " samples, there are " + std::to_string(octree.surfels.size()));
    }
    expect_all(sentences, octree.chunks.size(), "chunk", "lie outside the root cube",
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

bool is_empty_page(std::span<const char> bytes) {
    return std::all_of(bytes.begin(), bytes.end(), [](char b) { return b == 0; });
}

void check_checksums(const FileHeader& header, std::span<const char> file, Sentences& sentences) {
    std::vector<std::uint8_t> wrong(header.section_count, 0);
    tbb::parallel_for(std::uint32_t{0}, header.section_count, [&](std::uint32_t i) {
        const SectionEntry& s = header.sections[i];
        wrong[i] = XXH3_64bits(file.data() + s.offset, s.count * s.record_bytes) != s.checksum;
    });
    std::uint64_t end = sizeof(FileHeader);
    for (std::uint32_t i = 0; i < header.section_count; ++i) {
        const SectionEntry& s = header.sections[i];
        if (wrong[i]) {
            sentences.push_back("section " + std::to_string(i) + " (kind " +
                                std::to_string(s.kind) + ") does not match its checksum");
        }
        if (!is_empty_page(file.subspan(end, s.offset - end))) {
            sentences.push_back("the padding before section " + std::to_string(i) + " is not zero");
        }
        end = s.offset + s.count * s.record_bytes;
    }
    if (end != file.size()) {
        sentences.push_back(std::to_string(file.size() - end) + " bytes follow the last section");
    }
}

}  // namespace

std::vector<std::string> check_structure(const OctreeView& octree) {
    Sentences sentences;
    follow_tree(octree, sentences);
    check_ranges(octree, sentences);
    return sentences;
}

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
    if (!std::filesystem::is_regular_file(path)) {
        throw Error(ExitCode::kUnreadable, "there is no file '" + path.string() + "' to check");
    }
    try {
        const OctreeFile file = OctreeFile::open(path);
        Sentences sentences;
        check_checksums(file.header(), file.contents(), sentences);
        const Sentences structure = check_octree(file.view());
        sentences.insert(sentences.end(), structure.begin(), structure.end());
        file.require_intact();
        return sentences;
    } catch (const Error& error) {
        return {error.what()};
    }
}

}  // namespace glowworm
