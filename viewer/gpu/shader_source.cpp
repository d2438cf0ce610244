#include "viewer/gpu/shader_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <string_view>
#include <system_error>

#include "octree/error.h"

namespace glowworm {

namespace {

std::string_view without_indent(std::string_view line) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    return line;
}

void append_line(ShaderSource& source, std::string_view line, std::uint32_t file,
                 std::uint32_t number) {
    source.text.append(line).push_back('\n');
    source.lines.push_back({file, number});
}

void append_file(ShaderSource& source, const std::filesystem::path& path,
                 std::span<const std::string> defines, const std::string& wanted_by) {
    if (std::ranges::find(source.files, path) != source.files.end()) return;
    std::ifstream stream(path);
    if (!stream) {
        throw Error(ExitCode::kInternal, fmt::format("the shader {} that {} needs cannot be read",
                                                     path.string(), wanted_by));
    }
    const auto file = static_cast<std::uint32_t>(source.files.size());
    source.files.push_back(path);

    std::string line;
    for (std::uint32_t number = 1; std::getline(stream, line); ++number) {
        const std::string_view start = without_indent(line);
        if (start.starts_with("#include <")) {
            append_line(source, "", file, number);  // a shared header's C++ side
        } else if (start.starts_with("#include")) {
            const std::string here = fmt::format("{}:{}", path.filename().string(), number);
            const auto open = start.find('"');
            const auto close = start.rfind('"');
            if (open == std::string_view::npos || close <= open) {
                throw Error(ExitCode::kInternal, here + " has an #include without a quoted name");
            }
            append_file(source, path.parent_path() / start.substr(open + 1, close - open - 1), {},
                        here);
        } else if (start.starts_with("#version")) {
            append_line(source, line, file, number);
            for (const std::string& define : defines) {
                append_line(source, "#define " + define, file, number);
            }
        } else if (start.starts_with("#pragma once") ||
                   start.find("GL_GOOGLE_include_directive") != std::string_view::npos) {
            append_line(source, "", file, number);  // Mesa knows neither
        } else {
            append_line(source, line, file, number);
        }
    }
}

std::filesystem::path program_folder() {
    std::error_code failed;
    return std::filesystem::read_symlink("/proc/self/exe", failed).parent_path();
}

}  // namespace

std::string ShaderSource::explain(const std::string& log) const {
    static const std::regex place(R"(\b0(?::(\d+)|\((\d+)\)))");
    std::string explained;
    auto rest = log.begin();
    for (std::sregex_iterator match(log.begin(), log.end(), place), end; match != end; ++match) {
        const std::string digits = (*match)[1].matched ? (*match)[1].str() : (*match)[2].str();
        const std::size_t number = digits.size() < 8 ? std::stoul(digits) : 0;
        if (number == 0 || number > lines.size()) continue;
        explained.append(rest, (*match)[0].first);
        const Line& line = lines[number - 1];
        explained += fmt::format("{}:{}", files[line.file].filename().string(), line.line);
        rest = (*match)[0].second;
    }
    return explained.append(rest, log.end());
}

std::filesystem::path shader_folder() {
    std::error_code ignored;
    if (const char* named = std::getenv("GLOWWORM_SHADERS"); named != nullptr && *named != '\0') {
        if (std::filesystem::is_directory(named, ignored)) return named;
        throw Error(ExitCode::kUsage,
                    fmt::format("GLOWWORM_SHADERS names '{}', which is no folder", named));
    }
    const std::vector<std::filesystem::path> tried = {program_folder() / "shaders",
                                                      GLOWWORM_SHADER_FOLDER};
    for (const auto& folder : tried) {
        // A build folder has a `shaders` of its own, without shaders.
        if (std::filesystem::exists(folder / "gpu_layout.h", ignored)) return folder;
    }
    throw Error(ExitCode::kInternal,
                fmt::format("the shader folder {} is missing: set GLOWWORM_SHADERS to the folder "
                            "`shaders` of Glowworm's sources",
                            tried.back().string()));
}

ShaderSource read_shader(const std::filesystem::path& folder, const std::string& entry,
                         std::span<const std::string> defines) {
    ShaderSource source;
    append_file(source, folder / entry, defines, "the program");
    return source;
}

}  // namespace glowworm
