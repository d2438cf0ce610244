#include "octree/check.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "octree/error.h"
#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"

namespace glowworm {

void add_check_command(Program& program) {
    auto file = std::make_shared<std::filesystem::path>();
    CLI::App* command = program.add(
        "check", "every checksum and structural invariant of an octree file", false,
        [file](Run& run) -> nlohmann::ordered_json {
            page_memory(run);
            const std::vector<std::string> failures = check_octree_file(*file);
            nlohmann::ordered_json result = {
                {"file", file->string()}, {"ok", failures.empty()}, {"failures", failures}};
            if (failures.empty()) {
                if (!run.flags.json) fmt::print("'{}' is whole and sound\n", file->string());
                return result;
            }
            for (const std::string& failure : failures)
                spdlog::error("{}", failure);
            if (run.flags.json) fmt::print("{}\n", result.dump(2));
            throw Error(ExitCode::kCheckFailed,
                        fmt::format("'{}' fails {}; make it anew", file->string(),
                                    format_number_of(failures.size(), "check")));
        });
    command->add_option("file", *file, "an .svo file")->required();
}

}  // namespace glowworm
