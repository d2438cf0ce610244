#include "octree/output_path.h"

#include <unistd.h>

#include <iterator>
#include <string>
#include <system_error>

#include "octree/error.h"

namespace glowworm {
namespace {

/// Names like /dev/stdout, which may lead to a regular file: a rename would take the name's place.
bool is_of_the_system(const std::filesystem::path& path) {
    std::error_code ignored;
    const auto folder = std::filesystem::weakly_canonical(
        path.has_parent_path() ? path.parent_path() : std::filesystem::path("."), ignored);
    auto part = folder.begin();
    if (part == folder.end() || ++part == folder.end()) return false;
    const bool shared_memory = *part == "dev" && std::next(part) != folder.end();
    return (*part == "dev" && !shared_memory) || *part == "proc" || *part == "sys";
}

}  // namespace

void require_writable_output(const std::filesystem::path& path, bool force) {
    std::error_code ignored;
    const std::string name = "the output '" + path.string() + "'";
    if (path.empty()) throw Error(ExitCode::kUsage, "the output has no name; give one");
    if (path == "-") {
        throw Error(ExitCode::kUsage,
                    "'-' is no output: standard output carries the results of --json only; name a "
                    "file (./- for one of that name)");
    }
    if (is_of_the_system(path)) {
        throw Error(ExitCode::kUsage, name + " is no regular file; name a file");
    }
    const auto status = std::filesystem::status(path, ignored);
    if (std::filesystem::is_directory(status)) {
        throw Error(ExitCode::kUsage, name + " is a folder; name a file");
    }
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
        throw Error(ExitCode::kUsage, name + " is no regular file; name a file");
    }
    if (!force && std::filesystem::exists(status)) {
        throw Error(ExitCode::kExists, name + " exists; --force overwrites it");
    }
    const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
    if (!std::filesystem::is_directory(folder, ignored)) {
        throw Error(ExitCode::kUnreadable,
                    "the output's folder '" + folder.string() + "' does not exist; make it first");
    }
    if (::access(folder.c_str(), W_OK) != 0) {
        throw Error(ExitCode::kUnreadable,
                    "the output's folder '" + folder.string() + "' may not be written");
    }
}

void require_distinct(const std::filesystem::path& output,
                      const std::vector<std::filesystem::path>& inputs) {
    std::error_code ignored;
    for (const auto& input : inputs) {
        if (input.empty() || !std::filesystem::equivalent(output, input, ignored)) continue;
        throw Error(ExitCode::kUsage,
                    "'" + output.string() + "' is input and output at once; choose another output");
    }
}

void require_regular_input(const std::filesystem::path& path) {
    std::error_code ignored;
    const auto status = std::filesystem::status(path, ignored);
    if (std::filesystem::is_regular_file(status)) return;
    throw Error(ExitCode::kUnreadable,
                std::filesystem::exists(status)
                    ? "'" + path.string() + "' is no regular file; name a file"
                    : "cannot read '" + path.string() + "': there is no such file");
}

}  // namespace glowworm
