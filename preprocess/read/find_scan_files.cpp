#include <algorithm>
#include <set>
#include <system_error>

#include "octree/error.h"
#include "preprocess/read/closed_formats.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/read/registry.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

/// Takes the number at `at` off `text`, without leading zeros.
std::string_view take_digits(std::string_view text, std::size_t& at) {
    while (at + 1 < text.size() && text[at] == '0' && is_digit(text[at + 1]))
        ++at;
    const std::size_t begin = at;
    while (at < text.size() && is_digit(text[at]))
        ++at;
    return text.substr(begin, at - begin);
}

/// Numbers inside names by their value: "scan2" before "scan10".
bool natural_less(std::string_view a, std::string_view b) {
    std::size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string_view m = take_digits(a, i), n = take_digits(b, j);
            if (m.size() != n.size()) return m.size() < n.size();
            if (m != n) return m < n;
        } else {
            if (a[i] != b[j]) return a[i] < b[j];
            ++i;
            ++j;
        }
    }
    if ((i < a.size()) != (j < b.size())) return j < b.size();
    return a < b;
}

std::vector<fs::path> scan_files_in(const fs::path& folder) {
    std::vector<fs::path> found;
    const ClosedFormat* closed = nullptr;
    fs::path closed_file;
    std::error_code problem;
    for (fs::directory_iterator entry(folder, problem), end; !problem && entry != end;
         entry.increment(problem)) {
        std::error_code ignored;
        if (entry->path().filename().string().starts_with('.')) continue;
        const bool file = fs::is_regular_file(entry->path(), ignored);
        if (file && recognise_format(entry->path()) != nullptr) {
            found.push_back(entry->path());
        } else if (const ClosedFormat* format = closed_format_of(entry->path())) {
            closed = format;
            closed_file = entry->path();
        }
    }
    if (problem) {
        throw Error(ExitCode::kUnreadable, "cannot read the folder '" + folder.string() + "': " +
                                               problem.message() + "; check its permissions");
    }
    if (found.empty() && closed != nullptr) {
        throw Error(ExitCode::kUnreadable,
                    "cannot read '" + closed_file.string() + "': " + how_to_export(*closed));
    }
    if (found.empty()) {
        throw Error(ExitCode::kUnreadable,
                    "there is no scan in the folder '" + folder.string() +
                        "'; name the folder or the files that hold the scans");
    }
    std::ranges::sort(found, [](const fs::path& a, const fs::path& b) {
        return natural_less(a.filename().string(), b.filename().string());
    });
    return found;
}

}  // namespace

std::vector<fs::path> find_scan_files(std::span<const fs::path> files_or_folders) {
    std::vector<fs::path> files;
    for (const fs::path& path : files_or_folders) {
        std::error_code problem;
        const fs::file_status status = fs::status(path, problem);
        if (!fs::exists(status)) {
            throw Error(ExitCode::kUnreadable,
                        "cannot read '" + path.string() +
                            "': there is no such file or folder; check the path");
        }
        if (fs::is_directory(status)) {
            refuse_closed_folder(path);
            const std::vector<fs::path> inside = scan_files_in(path);
            files.insert(files.end(), inside.begin(), inside.end());
        } else {
            files.push_back(path);
        }
    }
    std::set<fs::path> seen;
    for (const fs::path& file : files) {
        std::error_code ignored;
        if (!seen.insert(fs::weakly_canonical(file, ignored)).second) {
            throw Error(ExitCode::kUsage,
                        "'" + file.string() + "' is given twice; name every scan once");
        }
    }
    return files;
}

}  // namespace glowworm
