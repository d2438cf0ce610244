#include "preprocess/command/grid_file.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/octree_file.h"
#include "octree/output_path.h"
#include "preprocess/command/octree_info.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

template <typename T>
Vec3<T> vector_at(const Json& grid, const char* key) {
    const Json& v = grid.at(key);
    return {v.at(0).get<T>(), v.at(1).get<T>(), v.at(2).get<T>()};
}

bool is_possible(const Grid& grid) {
    return is_finite(grid.origin) && is_finite(grid.cube_min) && std::isfinite(grid.cube_edge) &&
           grid.cube_edge > 0.0f && grid.depth <= kMaxDepth;
}

}  // namespace

Json grid_json(const Grid& grid) {
    return {{"origin", {grid.origin.x, grid.origin.y, grid.origin.z}},
            {"cube_min", {grid.cube_min.x, grid.cube_min.y, grid.cube_min.z}},
            {"cube_edge", grid.cube_edge},
            {"depth", grid.depth}};
}

Grid read_grid(const std::filesystem::path& path) {
    if (is_octree_file(path)) return OctreeFile::open(path).view().grid;
    require_regular_input(path);
    try {
        std::ifstream stream(path);
        const Json json = Json::parse(stream);
        const Json& at = json.contains("grid") ? json.at("grid") : json;
        const Grid grid{vector_at<double>(at, "origin"), vector_at<float>(at, "cube_min"),
                        at.at("cube_edge").get<float>(), at.at("depth").get<std::uint32_t>()};
        if (is_possible(grid)) return grid;
    } catch (const nlohmann::json::exception&) {
        // Said below.
    }
    throw Error(
        ExitCode::kUnreadable,
        fmt::format("'{}' holds no grid: it needs origin, cube_min, cube_edge and depth, as "
                    "`glowworm build --dry-run --json` prints them",
                    path.string()));
}

OctreeCell parse_cell(const std::string& key) {
    OctreeCell cell;
    const std::size_t first = key.starts_with('r') ? 1 : 0;
    bool is_key = key.size() > 0 && key.size() - first <= kMaxDepth;
    for (std::size_t i = first; is_key && i < key.size(); ++i) {
        is_key = key[i] >= '0' && key[i] <= '7';
        cell = {cell.level + 1, cell.code << 3 | static_cast<std::uint64_t>(key[i] - '0')};
    }
    if (is_key) return cell;
    throw Error(ExitCode::kUsage,
                fmt::format("'{}' is no cell: give one digit 0 to 7 a level, such as r073", key));
}

}  // namespace glowworm
