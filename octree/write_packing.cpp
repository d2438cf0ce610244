#include "octree/write_packing.h"

#include <vector>

#include "octree/chunk_packer.h"
#include "octree/octree_writer.h"

namespace glowworm {

BuildFileReport write_packing(const UnpackedOctree& built, const std::filesystem::path& path,
                              const Progress& progress, bool synced) {
    const OctreeView octree = built.octree.view();
    const std::uint64_t total = octree.sample_count + octree.dropped_count;
    const ChunkPacker packer(built.sorted.surfels, built.own, octree.grid);
    SharedProgress packing(progress, built.own.size(), 0.8, 1.0, total);
    const Progress still_here = [&](std::uint64_t, std::uint64_t) { packing.add(0); };

    OctreeWriter writer(path, {.progress = still_here, .synced = synced});
    std::vector<Chunk> chunks;
    const auto begin_points = [&] {
        write_tree_sections(octree, writer);
        writer.leave_section(SectionKind::kChunks, sizeof(Chunk), packer.chunks());
        writer.begin_section(SectionKind::kSurfels, sizeof(PackedSurfel));
    };
    packer.pack(packing, [&](const Chunk& chunk, std::span<const PackedSurfel> surfels) {
        if (chunks.empty()) begin_points();  // here, so that others pack meanwhile
        chunks.push_back(chunk);
        writer.append(surfels);
    });
    if (chunks.empty()) begin_points();
    writer.fill_section(SectionKind::kChunks, std::span<const Chunk>(chunks));
    write_table_sections(octree, writer);
    if (progress) progress(total, total);
    writer.finish(octree);
    return {.grid = octree.grid, .samples = octree.sample_count, .dropped = octree.dropped_count};
}

}  // namespace glowworm
