#include "preprocess/pipeline/up_to_date.h"

#include <sys/stat.h>
#include <sys/xattr.h>

#include <algorithm>
#include <ctime>

#include "octree/error.h"
#include "octree/octree_file.h"
#include "preprocess/pipeline/hash.h"

namespace glowworm {
namespace {

constexpr const char* kAttribute = "user.glowworm.inputs";
constexpr std::time_t kSettled = 2;  // s; coarser than any file system's clock but FAT's

}  // namespace

std::string state_of(std::span<const std::filesystem::path> files, const std::string& settings) {
    Hash hash;
    hash.add(settings);
    const std::time_t now = std::time(nullptr);
    for (const std::filesystem::path& file : files) {
        struct stat status = {};
        if (::stat(file.c_str(), &status) != 0) return {};
        if (std::max(status.st_mtim.tv_sec, status.st_ctim.tv_sec) > now - kSettled) return {};
        hash.add(file.string()).add(status.st_dev).add(status.st_ino).add(status.st_size);
        hash.add(status.st_mtim.tv_sec).add(status.st_mtim.tv_nsec);
        hash.add(status.st_ctim.tv_sec).add(status.st_ctim.tv_nsec);
    }
    return hash.hex();
}

void remember_state(const std::filesystem::path& output, const std::string& state) {
    if (state.empty()) return;
    // Without the attribute the next run takes longer, nothing else.
    [[maybe_unused]] const int failed =
        ::setxattr(output.c_str(), kAttribute, state.data(), state.size(), 0);
}

std::string remembered_state(const std::filesystem::path& output) {
    char state[64];
    const ssize_t size = ::getxattr(output.c_str(), kAttribute, state, sizeof(state));
    return size > 0 ? std::string(state, static_cast<std::size_t>(size)) : std::string();
}

std::string provenance_of(const std::filesystem::path& output) {
    try {
        return std::string(OctreeFile::open(output).view().provenance);
    } catch (const Error&) {
        return {};
    }
}

}  // namespace glowworm
