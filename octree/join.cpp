#include "octree/join.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "octree/crown.h"
#include "octree/error.h"
#include "octree/merge_chunks.h"
#include "octree/octree_writer.h"
#include "octree/structure.h"

namespace glowworm {
namespace {

[[noreturn]] void refuse(const std::string& why) {
    throw Error(ExitCode::kUsage, why);
}

/// Morton code of a tile's first or last leaf.
std::uint64_t edge_code(const OctreeView& tile, bool last) {
    std::uint64_t code = 0;
    std::uint32_t node = 0;
    for (std::uint32_t level = 0; level < tile.grid.depth; ++level) {
        const std::uint32_t mask = tile.nodes[node].mask & 0xff;
        const int octant = last ? std::bit_width(mask) - 1 : std::countr_zero(mask);
        node = tile.nodes[node].first +
               (last ? static_cast<std::uint32_t>(std::popcount(mask)) - 1 : 0);
        code = code << 3 | static_cast<std::uint64_t>(octant);
    }
    return code;
}

/// How many levels, counted from the root, each tile's first cells share with the tile before.
std::vector<std::uint32_t> shared_levels(std::span<const OctreeView> tiles) {
    const std::uint32_t depth = tiles.front().grid.depth;
    std::vector<std::uint32_t> shared(tiles.size(), 0);
    for (std::size_t t = 1; t < tiles.size(); ++t) {
        const std::uint64_t before = edge_code(tiles[t - 1], true);
        const std::uint64_t first = edge_code(tiles[t], false);
        if (first <= before) refuse("two of the tiles overlap; join tiles of one grid");
        const auto differing = static_cast<std::uint32_t>(std::bit_width(before ^ first));
        shared[t] = depth + 1 - (differing + 2) / 3;  // levels 0 .. depth - ceil(bits / 3)
    }
    return shared;
}

class Joiner {
  public:
    Joiner(std::span<const OctreeFile> files, std::span<const OctreeView> tiles,
           const std::filesystem::path& path, const WriteSettings& settings)
        : files_(files),
          tiles_(tiles),
          grid_(tiles.front().grid),
          crown_(build_crown(tiles)),
          shared_(shared_levels(tiles)),
          writer_(path, settings) {}

    void write(const JoinSettings& settings) {
        write_levels();
        write_nodes();
        write_attributes();
        section<Lobe>(SectionKind::kLobes, [&](const OctreeView& t) { return t.lobes; });
        write_points();
        const OctreeView& first = tiles_.front();
        table(SectionKind::kStations, first.stations);
        table(SectionKind::kAreaLights, first.area_lights);
        table(SectionKind::kNames, std::span<const char>(first.names));
        table(SectionKind::kProvenance, std::span<const char>(settings.provenance));
        finish(settings.dropped);
    }

  private:
    /// Of a tile's nodes at `level`, the first is also the last tile's last.
    bool shares_first(std::size_t tile, std::uint32_t level) const {
        return tile > 0 && shared_[tile] > level;
    }
    bool shares_last(std::size_t tile, std::uint32_t level) const {
        return tile + 1 < tiles_.size() && shared_[tile + 1] > level;
    }

    void write_levels() {
        std::uint64_t total = 0;
        for (std::uint32_t level = 0; level <= grid_.depth; ++level) {
            std::uint64_t count = 0;
            for (std::size_t t = 0; t < tiles_.size(); ++t) {
                count += tiles_[t].levels[level].node_count - (shares_first(t, level) ? 1 : 0);
            }
            levels_.push_back(
                {static_cast<std::uint32_t>(total), static_cast<std::uint32_t>(count)});
            total += count;
        }
        if (total > 0xffffffffu) refuse("the tiles have more than 4294967295 nodes together");
        table(SectionKind::kLevels, std::span<const Level>(levels_));
    }

    /// Calls `own(tile, begin, end)` for each run of nodes that one tile has alone and
    /// `shared(node)` for each that several have, in Morton order.
    template <typename Own, typename Shared>
    void for_each_run(std::uint32_t level, const Own& own, const Shared& shared) {
        auto next_shared = crown_.levels[level].begin();
        for (std::size_t t = 0; t < tiles_.size(); ++t) {
            const Level at = tiles_[t].levels[level];
            std::uint32_t begin = at.first_node, end = at.first_node + at.node_count;
            if (shares_first(t, level)) ++begin;
            const bool starts_shared = shares_last(t, level) && end > begin;
            if (starts_shared) --end;
            if (end > begin) own(t, begin, end);
            if (starts_shared) shared(*next_shared++);
            files_[t].forget_pages();
        }
    }

    void write_nodes() {
        writer_.begin_section(SectionKind::kNodes, sizeof(Node));
        std::vector<Node> nodes;
        std::uint64_t next = 0;
        for (std::uint32_t level = 0; level <= grid_.depth; ++level) {
            const bool leaves = level == grid_.depth;
            next = leaves ? 0 : levels_[level + 1].first_node;
            const auto place = [&](Node node) {
                node.first = static_cast<std::uint32_t>(next);
                next += leaves ? node.mask >> 8 : static_cast<unsigned>(std::popcount(node.mask));
                return node;
            };
            for_each_run(
                level,
                [&](std::size_t t, std::uint32_t begin, std::uint32_t end) {
                    nodes.clear();
                    for (std::uint32_t i = begin; i < end; ++i)
                        nodes.push_back(place(tiles_[t].nodes[i]));
                    writer_.append(std::span<const Node>(nodes));
                },
                [&](const SharedNode& shared) {
                    const Node node = place({shared.mask, 0});
                    writer_.append(&node, sizeof node);
                });
        }
        if (next > 0xffffffffu) refuse("the tiles have more than 4294967295 lobes together");
    }

    void write_attributes() {
        writer_.begin_section(SectionKind::kAttributes, sizeof(NodeAttributes));
        for (std::uint32_t level = 0; level <= grid_.depth; ++level) {
            for_each_run(
                level,
                [&](std::size_t t, std::uint32_t begin, std::uint32_t end) {
                    writer_.append(tiles_[t].attributes.subspan(begin, end - begin));
                },
                [&](const SharedNode& shared) {
                    writer_.append(&shared.attributes, sizeof shared.attributes);
                });
        }
    }

    std::span<const OctreeView> of_group(const ChunkGroup& group) const {
        return tiles_.subspan(group.first_tile, group.end_tile - group.first_tile);
    }

    void write_points() {
        std::vector<Chunk> chunks;
        std::uint64_t first = 0;
        const auto place = [&](Chunk chunk) {
            chunk.first = static_cast<std::uint32_t>(first);
            first += chunk.count;
            chunks.push_back(chunk);
        };
        for (const ChunkGroup& group : crown_.chunks) {
            if (group.merge) {
                place(merge_chunks(of_group(group)).chunk);
            } else {
                for (const Chunk& chunk : tiles_[group.first_tile].chunks)
                    place(chunk);
            }
        }
        if (first > 0xffffffffu) refuse("the tiles have more than 4294967295 points together");
        table(SectionKind::kChunks, std::span<const Chunk>(chunks));
        writer_.begin_section(SectionKind::kSurfels, sizeof(PackedSurfel));
        for (const ChunkGroup& group : crown_.chunks) {
            if (group.merge) {
                writer_.append(
                    std::span<const PackedSurfel>(merge_chunks(of_group(group)).surfels));
            } else {
                writer_.append(tiles_[group.first_tile].surfels);
            }
            for (std::uint32_t t = group.first_tile; t < group.end_tile; ++t)
                files_[t].forget_pages();
        }
    }

    template <typename T>
    void table(SectionKind kind, std::span<const T> records) {
        writer_.begin_section(kind, sizeof(T));
        writer_.append(records);
    }

    template <typename T, typename Select>
    void section(SectionKind kind, const Select& select) {
        writer_.begin_section(kind, sizeof(T));
        for (std::size_t t = 0; t < tiles_.size(); ++t) {
            writer_.append(std::span<const T>(select(tiles_[t])));
            files_[t].forget_pages();
        }
    }

    void finish(const std::optional<std::uint64_t>& dropped) {
        OctreeView joined;
        joined.grid = grid_;
        for (const OctreeView& tile : tiles_) {
            if (tile.sample_count > 0) {
                const bool first = joined.sample_count == 0;
                joined.bounds_min =
                    first ? tile.bounds_min : component_min(joined.bounds_min, tile.bounds_min);
                joined.bounds_max =
                    first ? tile.bounds_max : component_max(joined.bounds_max, tile.bounds_max);
            }
            joined.sample_count += tile.sample_count;
            joined.dropped_count += tile.dropped_count;
        }
        joined.dropped_count = dropped.value_or(joined.dropped_count);
        for (const OctreeFile& file : files_)
            file.require_intact();
        writer_.finish(joined);
    }

    std::span<const OctreeFile> files_;
    std::span<const OctreeView> tiles_;
    Grid grid_;
    Crown crown_;
    std::vector<std::uint32_t> shared_;
    std::vector<Level> levels_;
    OctreeWriter writer_;
};

template <typename T>
bool same_records(std::span<const T> a, std::span<const T> b) {
    return a.size() == b.size() &&
           (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

bool same_frame(const OctreeView& a, const OctreeView& b) {
    return a.grid.origin == b.grid.origin && a.grid.cube_min == b.grid.cube_min &&
           a.grid.cube_edge == b.grid.cube_edge && a.grid.depth == b.grid.depth &&
           same_records(a.stations, b.stations) && same_records(a.area_lights, b.area_lights) &&
           a.names == b.names;
}

}  // namespace

void join_octrees(std::span<const OctreeFile> tiles, const JoinSettings& settings,
                  const std::filesystem::path& path) {
    if (tiles.empty()) throw Error(ExitCode::kDegenerate, "there are no tiles to join");
    // In Morton order, whatever the order they were given in: by their first leaf.
    std::vector<OctreeFile> files(tiles.begin(), tiles.end());
    std::uint64_t bytes = 0;
    for (const OctreeFile& file : files) {
        bytes += file.bytes();
        if (settings.progress) settings.progress(0, bytes);
        const auto failures = check_structure(file.view());
        file.forget_pages();
        if (!failures.empty())
            throw Error(ExitCode::kUnreadable, "a tile is damaged: " + failures[0]);
    }
    std::stable_sort(files.begin(), files.end(), [&](const OctreeFile& a, const OctreeFile& b) {
        return edge_code(a.view(), false) < edge_code(b.view(), false);
    });
    std::vector<OctreeView> views;
    for (const OctreeFile& file : files) {
        views.push_back(file.view());
        if (!same_frame(views.front(), views.back())) {
            refuse("the tiles differ in grid, stations or lights; join tiles of one grid");
        }
    }
    Joiner(files, views, path, {settings.progress, bytes}).write(settings);
}

}  // namespace glowworm
