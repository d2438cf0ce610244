#include "octree/join.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "octree/checksums.h"
#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"
#include "preprocess/command/stage_flags.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

/// Tiles of one build say the same of where they come from, and so does what they join to. Tiles
/// made of different inputs join to something made of all of them.
JoinSettings settings_for(std::span<const OctreeFile> tiles) {
    const OctreeView& first = tiles.front().view();
    const bool same = std::ranges::all_of(
        tiles, [&](const OctreeFile& tile) { return tile.view().provenance == first.provenance; });
    // From the same input, each tile has counted all that was dropped of it.
    if (same) return {std::string(first.provenance), first.dropped_count, {}};

    Json provenance = Json::parse(first.provenance, nullptr, false);
    std::vector<Json> inputs;
    for (const OctreeFile& tile : tiles) {
        const Json of_tile = Json::parse(tile.view().provenance, nullptr, false);
        if (!of_tile.is_object() || !of_tile.contains("inputs")) continue;
        for (const Json& input : of_tile.at("inputs"))
            inputs.push_back(input);
    }
    std::ranges::sort(inputs, {}, [](const Json& input) { return input.dump(); });
    const auto again = std::ranges::unique(inputs);
    inputs.erase(again.begin(), again.end());
    if (!provenance.is_object()) provenance = Json::object();
    provenance["inputs"] = inputs;
    return {provenance.dump(-1, ' ', false, Json::error_handler_t::replace), {}, {}};
}

Json run_join(Run& run, const std::vector<std::filesystem::path>& inputs) {
    const std::filesystem::path& output = run.flags.output;
    require_distinct(output, inputs);
    page_memory(run);
    std::vector<OctreeFile> tiles;
    const Progress progress = run.console.phase("check", "tiles");
    for (const auto& input : inputs) {
        progress(tiles.size(), inputs.size());
        tiles.push_back(OctreeFile::open(input));
        require_sound(tiles.back(), input);
        tiles.back().forget_pages();
    }
    JoinSettings settings = settings_for(tiles);
    settings.progress = run.console.phase("join", "bytes");
    join_octrees(tiles, settings, output);
    run.console.end_phase();

    const OctreeFile file = OctreeFile::open(output);
    say_octree(file.view());
    return {{"output", output.string()},
            {"tiles", tiles.size()},
            {"samples", file.view().sample_count},
            {"leaves", file.view().levels.back().node_count},
            {"nodes", file.view().nodes.size()},
            {"depth", file.view().grid.depth},
            {"bytes", file.bytes()}};
}

}  // namespace

void add_join_command(Program& program) {
    auto inputs = std::make_shared<std::vector<std::filesystem::path>>();
    CLI::App* command =
        program.add("join", "tiles of one grid (build --tile) to the octree of the whole", true,
                    [inputs](Run& run) { return run_join(run, *inputs); });
    command->add_option("tiles", *inputs, ".svo files, in any order")->required();
}

}  // namespace glowworm
