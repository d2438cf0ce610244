#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace glowworm::testing {

/// The folder of real scans and lit scenes, from the environment variable GLOWWORM_DATA; nothing
/// where it is not set.
std::optional<std::filesystem::path> data_folder();

/// A folder of this test's own, made empty, removed when it goes out of scope.
class ScratchFolder {
  public:
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

  private:
    std::filesystem::path path_;
};

}  // namespace glowworm::testing

/// Skips the test, saying so, where GLOWWORM_DATA is not set; else defines `name` as the folder.
#define GLOWWORM_DATA_OR_SKIP(name)                                       \
    if (!glowworm::testing::data_folder()) {                              \
        GTEST_SKIP() << "GLOWWORM_DATA is not set: needs the real scans"; \
    }                                                                     \
    const std::filesystem::path name = *glowworm::testing::data_folder()
