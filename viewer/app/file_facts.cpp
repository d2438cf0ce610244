#include "viewer/app/file_facts.h"

#include <fmt/format.h>

namespace glowworm {

std::string file_facts(const std::filesystem::path& path, const Cave& cave) {
    const OctreeView& octree = cave.points();
    const Vec3f size = octree.bounds_max - octree.bounds_min;
    return fmt::format(
        "{}, {:.1f} MB\n{} points of {} stations\n{:.1f} x {:.1f} x {:.1f} m\n"
        "depth {}, voxels of {:.1f} mm\n{} nodes, {} lobes, light at depth {}{}\n"
        "{} area lights, {}",
        path.filename().string(), double(cave.file.bytes()) / 1e6, octree.surfels.size(),
        octree.stations.size(), size.x, size.y, size.z, octree.grid.depth,
        double(octree.grid.voxel_size()) * 1e3, octree.nodes.size(), octree.lobes.size(),
        cave.light().grid.depth,
        cave.light_groups > 0 ? fmt::format(" on {} groups", cave.light_groups) : "",
        octree.area_lights.size(),
        octree.links_per_lobe > 0 ? fmt::format("{} links a lobe baked", octree.links_per_lobe)
                                  : std::string("links not baked"));
}

}  // namespace glowworm
