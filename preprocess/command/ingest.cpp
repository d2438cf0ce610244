#include "preprocess/pipeline/ingest.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <numeric>

#include "preprocess/command/command.h"
#include "preprocess/command/convert_flags.h"
#include "preprocess/command/plan.h"
#include "preprocess/pipeline/work_folder.h"

namespace glowworm {
namespace {

/// Refuses what cannot fit: as many of the largest files as are read at a time.
void require_budget_for_files(Run& run, std::span<const std::filesystem::path> files,
                              const ReadSettings& read) {
    std::vector<std::uint64_t> points;
    for (const std::filesystem::path& file : files)
        points.push_back(announced_work(std::span(&file, 1), read).points);
    std::ranges::sort(points, std::greater());
    points.resize(std::min(points.size(), static_cast<std::size_t>(thread_count(run.flags))));
    Workload work;
    work.points = std::accumulate(points.begin(), points.end(), std::uint64_t{0});
    work.error = kPilotError;
    require_budget(run, predict(work), Reach::kRegister);
}

/// The first stage of `convert`, for some of its scans.
nlohmann::ordered_json run_ingest(Run& run, ConvertFlags flags) {
    const auto files = find_scan_files(flags.inputs);
    require_distinct(run.flags.output, files);
    require_budget_for_files(run, files, flags.settings.read);
    const std::vector<ScanInput> inputs = describe_scans(files, run.console.phase("look", "bytes"));
    run.console.end_phase();
    const WorkFolder work(run.flags.output, run.flags.temp_dir, WorkFolder::Hold::kShared);

    std::vector<std::string> keys;
    for (const ScanInput& input : inputs)
        keys.push_back(ingest_key(input, flags.settings));
    const std::vector<Ingested> all =
        ingest_into(work, files, {flags.settings.read, flags.settings.clean},
                    run.console.phase("read", "files"), keys);
    run.console.end_phase();

    nlohmann::ordered_json scans = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        scans.push_back({{"file", inputs[i].path.string()},
                         {"bytes", inputs[i].content.bytes},
                         {"hash", inputs[i].content.hash},
                         {"scans", all[i].scans.size()},
                         {"points", all[i].points},
                         {"outliers", all[i].outliers}});
    }
    run.last_word = fmt::format("{} read, kept in '{}'", format_number_of(files.size(), "file"),
                                work.path().string());
    return {{"work", work.path().string()}, {"inputs", scans}};
}

}  // namespace

void add_ingest_command(Program& program) {
    auto flags = std::make_shared<ConvertFlags>();
    CLI::App* command = program.add(
        "ingest", "read and clean some of the scans of a later `convert` to the same output", true,
        [flags](Run& run) { return run_ingest(run, *flags); }, {}, true);
    command->add_option("scans", flags->inputs, "scan files or folders of them")->required();
    add_read_flags(*command, flags->settings.read);
}

}  // namespace glowworm
