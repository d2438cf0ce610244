#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glowworm::testing {

/// How a program ended and what it said.
struct Ended {
    int code = -1;  ///< exit code; 128 + n where signal n ended it
    std::string out, err;
    long peak = 0;  ///< bytes that it occupied at its peak
};

/// Runs a program to its end with its arguments as they are, without a shell.
Ended run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments);

/// Runs `glowworm`.
Ended glowworm(const std::vector<std::string>& arguments);

/// Runs `glowworm-view`.
Ended glowworm_view(const std::vector<std::string>& arguments);

/// Names of everything in a folder, hidden files too: to see that nothing was left behind.
std::vector<std::string> names_in(const std::filesystem::path& folder);

}  // namespace glowworm::testing
