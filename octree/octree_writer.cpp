#include "octree/octree_writer.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>
#include <vector>

namespace glowworm {
namespace {

constexpr std::size_t kPieceBytes = 8 << 20;  // between two calls of progress

template <typename Records>
void write_section(SectionKind kind, const Records& records, OctreeWriter& writer) {
    writer.begin_section(kind, sizeof records[0]);
    writer.append(records.data(), records.size() * sizeof records[0]);
}

}  // namespace

Progress all_done(Progress progress, std::uint64_t total) {
    if (!progress) return {};
    return [progress = std::move(progress), total](std::uint64_t, std::uint64_t) {
        progress(total, total);
    };
}

struct OctreeWriter::Hash {
    XXH3_state_t* state = XXH3_createState();
    ~Hash() { XXH3_freeState(state); }
};

OctreeWriter::OctreeWriter(const std::filesystem::path& path, const WriteSettings& settings)
    : settings_(settings), file_(path), hash_(std::make_unique<Hash>()) {
    std::memcpy(header_.magic, kMagic, sizeof kMagic);
    header_.version = kFormatVersion;
}

OctreeWriter::~OctreeWriter() = default;

void OctreeWriter::begin_section(SectionKind kind, std::size_t record_bytes) {
    end_section();
    position_ = (position_ + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment;
    SectionEntry& entry = header_.sections[header_.section_count++];
    entry.kind = static_cast<std::uint32_t>(kind);
    entry.record_bytes = static_cast<std::uint32_t>(record_bytes);
    entry.offset = position_;
    section_open_ = true;
    section_bytes_ = 0;
    XXH3_64bits_reset(hash_->state);
}

void OctreeWriter::leave_section(SectionKind kind, std::size_t record_bytes, std::size_t count) {
    begin_section(kind, record_bytes);
    section_open_ = false;
    header_.sections[header_.section_count - 1].count = count;
    position_ += count * record_bytes;
}

void OctreeWriter::fill_section(SectionKind kind, const void* records, std::size_t bytes) {
    SectionEntry& entry =
        *std::ranges::find(header_.sections, static_cast<std::uint32_t>(kind), &SectionEntry::kind);
    entry.checksum = XXH3_64bits(records, bytes);
    file_.write_at(entry.offset, records, bytes);
}

void OctreeWriter::append(const void* records, std::size_t bytes) {
    const char* next = static_cast<const char*>(records);
    section_bytes_ += bytes;
    while (bytes > 0) {
        const std::size_t piece = std::min(bytes, kPieceBytes);
        if (settings_.progress)
            settings_.progress(position_, std::max(position_, settings_.expected_bytes));
        XXH3_64bits_update(hash_->state, next, piece);
        file_.write_at(position_, next, piece);
        position_ += piece;
        next += piece;
        bytes -= piece;
    }
}

void OctreeWriter::end_section() {
    if (!section_open_) return;
    section_open_ = false;
    SectionEntry& entry = header_.sections[header_.section_count - 1];
    entry.count = section_bytes_ / entry.record_bytes;
    entry.checksum = XXH3_64bits_digest(hash_->state);
}

void OctreeWriter::finish(const OctreeView& octree) {
    end_section();
    header_.depth = octree.grid.depth;
    header_.file_bytes = position_;
    for (int axis = 0; axis < 3; ++axis) {
        header_.origin[axis] = octree.grid.origin[axis];
        header_.cube_min[axis] = octree.grid.cube_min[axis];
        header_.bounds_min[axis] = octree.bounds_min[axis];
        header_.bounds_max[axis] = octree.bounds_max[axis];
    }
    header_.cube_edge = octree.grid.cube_edge;
    header_.sample_count = octree.sample_count;
    header_.dropped_count = octree.dropped_count;
    header_.links_per_lobe = octree.links_per_lobe;
    header_.checksum = XXH3_64bits(&header_, offsetof(FileHeader, checksum));

    // The header's page last: until then nothing under the temporary name decodes.
    std::vector<char> page(kSectionAlignment, 0);
    std::memcpy(page.data(), &header_, sizeof header_);
    file_.write_at(0, page.data(), page.size());
    file_.commit(settings_.synced);
}

void write_tree_sections(const OctreeView& octree, OctreeWriter& writer) {
    write_section(SectionKind::kLevels, octree.levels, writer);
    write_section(SectionKind::kNodes, octree.nodes, writer);
    write_section(SectionKind::kAttributes, octree.attributes, writer);
    write_section(SectionKind::kLobes, octree.lobes, writer);
}

void write_table_sections(const OctreeView& octree, OctreeWriter& writer) {
    write_section(SectionKind::kStations, octree.stations, writer);
    write_section(SectionKind::kAreaLights, octree.area_lights, writer);
    write_section(SectionKind::kNames, octree.names, writer);
    write_section(SectionKind::kProvenance, octree.provenance, writer);
    if (octree.links_per_lobe > 0) write_section(SectionKind::kLinks, octree.links, writer);
}

void write_octree_file(const OctreeView& octree, const std::filesystem::path& path) {
    write_octree_file(octree, path, {});
}

void write_octree_file(const OctreeView& octree, const std::filesystem::path& path,
                       WriteSettings settings) {
    settings.expected_bytes = octree.nodes.size_bytes() + octree.attributes.size_bytes() +
                              octree.lobes.size_bytes() + octree.chunks.size_bytes() +
                              octree.surfels.size_bytes() + octree.links.size_bytes();
    OctreeWriter writer(path, settings);
    write_tree_sections(octree, writer);
    write_section(SectionKind::kChunks, octree.chunks, writer);
    write_section(SectionKind::kSurfels, octree.surfels, writer);
    write_table_sections(octree, writer);
    writer.finish(octree);
}

}  // namespace glowworm
