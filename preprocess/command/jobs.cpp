#include <fmt/format.h>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/convert_flags.h"
#include "preprocess/pipeline/shares.h"
#include "preprocess/pipeline/work_folder.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

/// The flags of a stage that many jobs share, the same as of the `convert` they work for.
struct JobFlags : ConvertFlags {
    std::string part;
};

/// What a job needs of `convert`: everything that its keys are made of.
struct Job {
    ConvertFlags flags;
    std::vector<ScanInput> inputs;
};

Job prepare(Run& run, ConvertFlags flags) {
    const auto files = find_scan_files(flags.inputs);
    require_distinct(run.flags.output, files);
    flags.apply();
    std::vector<ScanInput> inputs = describe_scans(files, run.console.phase("look", "bytes"));
    run.console.end_phase();
    flags.apply_provenance(inputs);
    return {std::move(flags), std::move(inputs)};
}

Json run_inventory(const std::vector<std::filesystem::path>& given) {
    Json files = Json::array();
    for (const std::filesystem::path& file : find_scan_files(given))
        files.push_back(file.string());
    return {{"files", files}};
}

Json run_pairs(Run& run, const JobFlags& flags) {
    const Job job = prepare(run, flags);
    const WorkFolder work(run.flags.output, run.flags.temp_dir, WorkFolder::Hold::kShared);
    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return run.console.phase(phase, unit);
    };
    const std::size_t pairs = flags.part.empty()
                                  ? plan_share_of_pairs(job.inputs, job.flags.settings, begin, work)
                                  : try_share_of_pairs(job.inputs, job.flags.settings, begin, work,
                                                       parse_share(flags.part));
    run.console.end_phase();
    run.last_word = fmt::format("{} {}, kept in '{}'", format_number_of(pairs, "pair"),
                                flags.part.empty() ? "to try" : "tried", work.path().string());
    return {{"work", work.path().string()}, {"pairs", pairs}};
}

Json run_tile(Run& run, const JobFlags& flags) {
    const Job job = prepare(run, flags);
    const WorkFolder work(run.flags.output, run.flags.temp_dir, WorkFolder::Hold::kShared);
    const auto begin = [&](const std::string& phase, const std::string& unit) {
        return run.console.phase(phase, unit);
    };
    const std::size_t tiles =
        build_share_of_tiles(job.inputs, job.flags.settings, begin, work, parse_share(flags.part));
    run.console.end_phase();
    run.last_word =
        fmt::format("{}, kept in '{}'", format_number_of(tiles, "tile"), work.path().string());
    return {{"work", work.path().string()}, {"tiles", tiles}};
}

}  // namespace

void add_job_commands(Program& program) {
    auto given = std::make_shared<std::vector<std::filesystem::path>>();
    CLI::App* inventory =
        program.add("inventory", "the scan files that `convert` would take, in its order (--json)",
                    false, [given](Run& run) {
                        const Json found = run_inventory(*given);
                        if (!run.flags.json)
                            for (const Json& file : found.at("files"))
                                fmt::print("{}\n", file.get<std::string>());
                        return found;
                    });
    inventory->add_option("scans", *given, "scan files or folders of them")->required();

    auto pairs = std::make_shared<JobFlags>();
    CLI::App* try_pairs = program.add(
        "pairs",
        "which pairs of scans a later `convert` with the same flags will try, and a part "
        "of these tried now",
        true, [pairs](Run& run) { return run_pairs(run, *pairs); }, {}, true);
    pairs->add_to(*try_pairs);
    try_pairs->add_option("--part", pairs->part,
                          "try a part of the pairs, such as 2/8; without it find out which there "
                          "are");

    auto tiles = std::make_shared<JobFlags>();
    CLI::App* build_tiles = program.add(
        "tile", "a part of the octree's tiles for a later `convert` with the same flags to join",
        true, [tiles](Run& run) { return run_tile(run, *tiles); }, {}, true);
    tiles->add_to(*build_tiles);
    build_tiles->add_option("--part", tiles->part, "which part of the tiles, such as 2/8")
        ->required();
}

}  // namespace glowworm
