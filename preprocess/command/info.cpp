#include <algorithm>
#include <cstring>
#include <fstream>

#include "octree/node_layout.h"
#include "preprocess/command/command.h"
#include "preprocess/command/octree_info.h"
#include "preprocess/command/scan_info.h"
#include "preprocess/command/stage_flags.h"

namespace glowworm {
namespace {

/// By content, not by name; a file that cannot be read is left to the scan readers' sentence.
bool is_octree_file(const std::filesystem::path& path) {
    char start[sizeof(kMagic)] = {};
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored)) return false;
    std::ifstream(path, std::ios::binary).read(start, sizeof(start));
    return std::memcmp(start, kMagic, sizeof(kMagic)) == 0;
}

}  // namespace

void add_info_command(Program& program) {
    struct Flags {
        std::filesystem::path file;
        ReadSettings read;
    };
    auto flags = std::make_shared<Flags>();
    CLI::App* command =
        program.add("info", "what is in an octree file or a scan", false, [flags](Run& run) {
            return is_octree_file(flags->file) ? octree_info(flags->file, run.flags.json)
                                               : scan_info(flags->file, flags->read, run);
        });
    command->add_option("file", flags->file, "an .svo or any scan")->required();
    add_read_flags(*command, flags->read);
}

}  // namespace glowworm
