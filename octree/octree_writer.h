#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "octree/atomic_file.h"
#include "octree/octree_file.h"
#include "octree/progress.h"

namespace glowworm {

struct WriteSettings {
    Progress progress = {};            ///< bytes written, told every few MiB; may throw to cancel
    std::uint64_t expected_bytes = 0;  ///< that `progress` takes for the total
    bool synced = true;  ///< on the disk before it has its name; false for what no crash outlives
};

/// Reports that all of `total` is done, however far it is: for what follows the work that
/// `progress` counts and may be cancelled just as well.
Progress all_done(Progress progress, std::uint64_t total);

/// Writes an .svo section after section, in any amount at a time, so that nobody needs to hold one
/// whole. Destroyed before `finish`, it leaves no file. Members throw as AtomicFile does.
class OctreeWriter {
  public:
    explicit OctreeWriter(const std::filesystem::path& path, const WriteSettings& settings = {});
    ~OctreeWriter();

    /// Sections begin in the order in which they shall lie in the file.
    void begin_section(SectionKind kind, std::size_t record_bytes);
    void append(const void* records, std::size_t bytes);
    template <typename T>
    void append(std::span<const T> records) {
        append(records.data(), records.size_bytes());
    }

    /// Leaves room for `count` records in place of a section that is filled once they are known.
    void leave_section(SectionKind kind, std::size_t record_bytes, std::size_t count);
    template <typename T>
    void fill_section(SectionKind kind, std::span<const T> records) {
        fill_section(kind, records.data(), records.size_bytes());
    }

    /// Writes the header from `octree`'s grid, bounds and counts (its spans are not looked at) and
    /// gives the file its name.
    void finish(const OctreeView& octree);

  private:
    void fill_section(SectionKind kind, const void* records, std::size_t bytes);
    void end_section();

    struct Hash;
    WriteSettings settings_;
    AtomicFile file_;
    std::unique_ptr<Hash> hash_;
    FileHeader header_{};
    bool section_open_ = false;
    std::uint64_t section_bytes_ = 0;
    std::uint64_t position_ = kSectionAlignment;
};

/// The sections before the chunks, and those after the points.
void write_tree_sections(const OctreeView& octree, OctreeWriter& writer);
void write_table_sections(const OctreeView& octree, OctreeWriter& writer);

/// As the one of octree_file.h. The settings' `expected_bytes` are those of the octree.
void write_octree_file(const OctreeView& octree, const std::filesystem::path& path,
                       WriteSettings settings);

}  // namespace glowworm
