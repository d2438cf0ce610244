#include "octree/file_size.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "octree/error.h"
#include "octree/octree_file.h"
#include "octree/splat.h"

namespace glowworm {

SizeEstimate estimate_size(const CloudSummary& summary, const Grid& grid) {
    constexpr double kLobesPerLeaf = 1.2;  // measured on scans
    const auto samples = static_cast<double>(summary.usable);
    const double most = samples * splat_of(summary.median_radius / grid.voxel_size()).pieces;
    const double area = samples * summary.median_spacing() * summary.median_spacing();

    SizeEstimate size;
    double edge = grid.cube_edge;
    for (std::uint32_t level = 0; level <= grid.depth; ++level, edge *= 0.5) {
        // A surface crosses about twice as many cells as it covers cell faces.
        size.leaves = std::clamp(2.0 * area / (edge * edge), 1.0, most);
        size.nodes += size.leaves;
    }
    size.bytes = static_cast<std::uint64_t>(samples * sizeof(PackedSurfel) +
                                            size.nodes * (sizeof(Node) + sizeof(NodeAttributes)) +
                                            size.leaves * kLobesPerLeaf * sizeof(Lobe));
    return size;
}

void require_room(const SizeEstimate& estimate, const std::filesystem::path& path) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::error_code failed;
    const std::filesystem::space_info space = std::filesystem::space(folder, failed);
    if (failed || space.available >= estimate.bytes / 2) return;
    throw Error(ExitCode::kBudget,
                "the octree will take about " + std::to_string(estimate.bytes / 1000000) +
                    " MB, but '" + folder.string() + "' has " +
                    std::to_string(space.available / 1000000) +
                    " MB left; build it less deep, with larger voxels, or free some space");
}

}  // namespace glowworm
