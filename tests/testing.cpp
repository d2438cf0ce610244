#include "testing.h"

#include <unistd.h>

#include <cstdlib>
#include <stdexcept>

namespace glowworm::testing {

std::optional<std::filesystem::path> data_folder() {
    const char* folder = std::getenv("GLOWWORM_DATA");
    if (folder == nullptr || *folder == '\0') return std::nullopt;
    return std::filesystem::path(folder);
}

ScratchFolder::ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "glowworm-test-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make " + pattern);
    path_ = pattern;
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

}  // namespace glowworm::testing
