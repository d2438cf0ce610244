#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace glowworm {

/// A shader after its includes were put in, and where each of its lines came from. GLSL has no
/// include and Mesa refuses `#line 1 "file"`, so the table is ours.
struct ShaderSource {
    struct Line {
        std::uint32_t file;  ///< index into files
        std::uint32_t line;  ///< 1-based
    };
    std::string text;
    std::vector<std::filesystem::path> files;  ///< the entry first, then what it includes
    std::vector<Line> lines;                   ///< [lines of text]

    /// A driver's log with "0:123" and "0(123)" replaced by "file.glsl:12".
    std::string explain(const std::string& log) const;
};

/// The folder the shaders are read from: the environment variable GLOWWORM_SHADERS, else `shaders`
/// beside the program, else the source tree this was built from. Throws Error (kInternal) where
/// none of them exists.
std::filesystem::path shader_folder();

/// Reads `entry` (a file name inside `folder`) and puts in each `#include "name"` once, looked up
/// in `folder`. `defines` ("NAME value") follow the #version line. Throws Error (kInternal) that
/// names the file and line of an include that is missing.
ShaderSource read_shader(const std::filesystem::path& folder, const std::string& entry,
                         std::span<const std::string> defines = {});

}  // namespace glowworm
