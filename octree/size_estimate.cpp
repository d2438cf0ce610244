#include "octree/size_estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "octree/error.h"
#include "octree/node_layout.h"
#include "octree/splat.h"

namespace glowworm {
namespace {

constexpr double kMostNodes = std::numeric_limits<std::uint32_t>::max();

std::string in_gigabytes(std::uint64_t bytes) {
    return std::to_string(bytes / 1000000000) + "." + std::to_string(bytes / 100000000 % 10) +
           " GB";
}

/// The deepest octree over the same cube that fits, as advice.
std::string what_fits(const CloudSummary& summary, Grid grid, std::uint64_t disk) {
    while (grid.depth-- > 1) {
        const SizeEstimate size = estimate_size(summary, grid);
        if (size.disk <= disk && size.nodes <= kMostNodes)
            return "--depth " + std::to_string(grid.depth) + " fits";
    }
    return "thin the points";
}

}  // namespace

SizeEstimate estimate_size(const CloudSummary& summary, const Grid& grid) {
    constexpr double kLobesPerLeaf = 1.2;  // measured on scans
    const auto samples = static_cast<double>(summary.usable);
    const double voxel = grid.voxel_size();
    double most = samples, area = 0.0;
    if (!summary.radii.empty()) {
        double pieces = 0.0;
        for (const float radius : summary.radii) {
            pieces += splat_of(radius / voxel).pieces;
            area += std::numbers::pi * radius * radius;
        }
        const double each = samples / static_cast<double>(summary.radii.size());
        most = pieces * each;
        area *= each;
    }

    SizeEstimate size;
    double edge = grid.cube_edge;
    for (std::uint32_t level = 0; level <= grid.depth; ++level, edge *= 0.5) {
        // A surface crosses about twice as many cells as it covers cell faces.
        size.leaves = std::clamp(2.0 * area / (edge * edge), 1.0, most);
        size.nodes += size.leaves;
    }
    size.disk = static_cast<std::uint64_t>(samples * sizeof(PackedSurfel) +
                                           size.nodes * (sizeof(Node) + sizeof(NodeAttributes)) +
                                           size.leaves * kLobesPerLeaf * sizeof(Lobe));
    size.memory = static_cast<std::uint64_t>(
        samples * kBytesPerSurfel + std::max(0.0, size.leaves - samples) * kBytesPerLeaf +
        std::max(0.0, size.nodes - 1.5 * std::max(size.leaves, samples)) * kBytesPerNode);
    return size;
}

void require_room(const CloudSummary& summary, const Grid& grid,
                  const std::filesystem::path& path) {
    constexpr std::uint64_t kAny = std::numeric_limits<std::uint64_t>::max();
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    std::error_code failed;
    const std::filesystem::space_info space = std::filesystem::space(folder, failed);
    const std::uint64_t disk = failed ? kAny : space.available;

    // An estimate: only what is sure not to do is refused.
    const SizeEstimate size = estimate_size(summary, grid);
    const std::string octree = "an octree of depth " + std::to_string(grid.depth);
    const std::string instead = "; " + what_fits(summary, grid, disk);
    if (size.nodes / 2.0 > kMostNodes) {
        throw Error(ExitCode::kBudget,
                    octree +
                        " over these points has more nodes than 4294967295, the most that a "
                        "file holds" +
                        instead);
    }
    if (size.disk / 2 > disk) {
        throw Error(ExitCode::kBudget, octree + " takes about " + in_gigabytes(size.disk) +
                                           " on disk, but '" + folder.string() + "' has " +
                                           in_gigabytes(disk) + " left" + instead);
    }
}

}  // namespace glowworm
