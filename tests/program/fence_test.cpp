// The direction of dependency, preprocess → octree ← viewer → shaders, held by reading every
// #include: the compiler cannot hold it, because all libraries lie in the same system include
// folder.

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include "testing.h"

namespace {

namespace fs = std::filesystem;

struct Include {
    fs::path file;       ///< relative to the root
    std::string target;  ///< without quotes or brackets
    bool ours = false;   ///< in quotes
};

std::vector<Include> includes_below(const std::string& folder) {
    static const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
    std::vector<Include> found;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(GLOWWORM_ROOT) / folder)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".h" && extension != ".cpp") continue;
        std::ifstream stream(entry.path());
        std::smatch match;
        for (std::string line; std::getline(stream, line);) {
            if (!std::regex_search(line, match, pattern)) continue;
            found.push_back(
                {fs::relative(entry.path(), GLOWWORM_ROOT), match[2], match[1] == "\""});
        }
    }
    return found;
}

bool starts_with_any(const std::string& text, const std::vector<std::string>& prefixes) {
    for (const auto& prefix : prefixes) {
        if (text.starts_with(prefix)) return true;
    }
    return false;
}

const std::vector<std::string> kToolLibraries = {"pcl/", "CGAL/", "ceres/", "flann/"};
const std::vector<std::string> kViewerLibraries = {"epoxy/", "GL/",  "EGL/",
                                                   "GLFW/",  "glm/", "imgui"};

TEST(Fence, TheOctreeKnowsOnlyTheStandardLibraryTbbAndXxhash) {
    const std::set<std::string> posix = {"fcntl.h", "unistd.h", "xxhash.h", "signal.h", "setjmp.h"};
    const auto includes = includes_below("octree");
    ASSERT_FALSE(includes.empty());
    for (const Include& include : includes) {
        const bool standard = include.target.find_first_of("./") == std::string::npos;
        const bool scene_reads_json =
            include.file.filename() == "scene.cpp" && include.target == "nlohmann/json.hpp";
        EXPECT_TRUE(include.ours ? include.target.starts_with("octree/")
                                 : standard || posix.contains(include.target) || scene_reads_json ||
                                       starts_with_any(include.target, {"tbb/", "sys/"}))
            << include.file << " includes " << include.target;
    }
}

TEST(Fence, TheToolsNeverReachIntoTheViewer) {
    const auto includes = includes_below("preprocess");
    ASSERT_FALSE(includes.empty());
    for (const Include& include : includes) {
        EXPECT_FALSE(include.ours && !starts_with_any(include.target, {"preprocess/", "octree/"}))
            << include.file << " includes " << include.target;
        EXPECT_FALSE(starts_with_any(include.target, kViewerLibraries))
            << include.file << " includes " << include.target;
    }
}

TEST(Fence, TheViewerNeverReachesIntoTheTools) {
    const auto includes = includes_below("viewer");
    ASSERT_FALSE(includes.empty());
    for (const Include& include : includes) {
        EXPECT_FALSE(include.target.starts_with("preprocess/") ||
                     include.target.starts_with("Eigen/"))
            << include.file << " includes " << include.target;
        EXPECT_FALSE(starts_with_any(include.target, kToolLibraries))
            << include.file << " includes " << include.target;
    }
}

TEST(Fence, HeavyLibrariesStayOutOfHeaders) {
    for (const Include& include : includes_below("preprocess")) {
        if (include.file.extension() != ".h") continue;
        EXPECT_FALSE(starts_with_any(include.target, kToolLibraries))
            << include.file << " includes " << include.target;
    }
}

}  // namespace
