#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "octree/grid.h"
#include "octree/node_layout.h"
#include "octree/vec3.h"

namespace glowworm {

/// Everything in an octree as spans, whether it lies in a mapped file or was just built. Owns
/// nothing; valid as long as what it points into.
struct OctreeView {
    Grid grid;
    Vec3f bounds_min, bounds_max;  ///< m, relative to grid.origin
    std::uint64_t sample_count = 0;
    std::uint64_t dropped_count = 0;
    std::span<const Level> levels;  ///< [depth + 1]
    std::span<const Node> nodes;
    std::span<const NodeAttributes> attributes;
    std::span<const Lobe> lobes;
    std::span<const Chunk> chunks;
    std::span<const PackedSurfel> surfels;
    std::span<const StationRecord> stations;
    std::span<const AreaLightRecord> area_lights;
    std::string_view names;
    std::string_view provenance;           ///< JSON
    std::span<const std::uint32_t> links;  ///< [lobes x links_per_lobe], empty where not baked
    std::uint32_t links_per_lobe = 0;
};

class FileMapping;

/// A file mapped read-only. Copies share the mapping; views live as long as one of them.
class OctreeFile {
  public:
    /// Maps `path` after checking its header and the bounds of every section, in time linear in the
    /// number of sections. Throws Error (kUnreadable) for anything that is not a whole, current
    /// .svo. What the sections hold is not looked at: see check_structure.
    static OctreeFile open(const std::filesystem::path& path);

    const OctreeView& view() const { return view_; }
    std::uint64_t bytes() const { return header_.file_bytes; }
    const FileHeader& header() const { return header_; }
    std::span<const char> contents() const;  ///< all bytes of the file

    /// Throws Error (kUnreadable) if a page that was read since `open` turned out to be missing,
    /// because another program cut the file; it read as zeros instead of raising a signal. To be
    /// asked after the sections have been read, before what came of them is believed.
    void require_intact() const;

    /// Tells the system that the pages read so far are not needed any more: they count as this
    /// program's memory until then. Views stay valid.
    void forget_pages() const;

  private:
    std::shared_ptr<const FileMapping> mapping_;
    std::filesystem::path path_;
    FileHeader header_{};
    OctreeView view_;
};

/// Whether `path` is a regular file that begins as an .svo of this version does, by content and not
/// by name. False for what cannot be read.
bool is_octree_of_this_version(const std::filesystem::path& path);

/// Writes `octree` under `path`: temporary name, checksums, fsync, rename. Same octree, same bytes.
/// Throws Error (kBudget) when the disk is full, (kUnreadable) when the folder cannot be written.
void write_octree_file(const OctreeView& octree, const std::filesystem::path& path);

}  // namespace glowworm
