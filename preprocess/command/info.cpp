#include <fstream>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/octree_info.h"
#include "preprocess/command/plan.h"
#include "preprocess/command/scan_info.h"
#include "preprocess/command/stage_flags.h"

namespace glowworm {
namespace {

/// A file of ours that is neither, so that the sentence says what it is.
void refuse_json(const std::filesystem::path& path) {
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return;
    std::string start(4096, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    const std::size_t first = start.find_first_not_of(" \t\r\n");
    if (first == std::string::npos || start[first] != '{') return;
    const bool poses = start.find("T_world_scan") != std::string::npos;
    throw Error(ExitCode::kUnreadable,
                "'" + path.string() + "' is " +
                    (poses ? "a poses.json, the scans' poses and how far each is trusted, as "
                             "`glowworm merge --poses` takes it; "
                           : "JSON; ") +
                    "info reads scans and octree files");
}

}  // namespace

void add_info_command(Program& program) {
    struct Flags {
        std::filesystem::path file;
        ReadSettings read;
        std::filesystem::path plot;
    };
    auto flags = std::make_shared<Flags>();
    CLI::App* command =
        program.add("info", "what is in an octree file or a scan", false, [flags](Run& run) {
            refuse_json(flags->file);
            const bool octree = is_octree_file(flags->file);
            if (!flags->plot.empty()) {
                if (!octree) throw Error(ExitCode::kUsage, "--plot draws the levels of an .svo");
                require_writable_output(flags->plot, run.flags.force);
                require_distinct(flags->plot, {flags->file});
            }
            if (octree) page_memory(run);
            return octree ? octree_info(flags->file, run.flags.json, flags->plot)
                          : scan_info(flags->file, flags->read, run);
        });
    command->add_option("file", flags->file, "an .svo or any scan")->required();
    command->add_option("--plot", flags->plot,
                        "draw histograms of every level of an .svo into this PNG");
    add_read_flags(*command, flags->read);
}

}  // namespace glowworm
