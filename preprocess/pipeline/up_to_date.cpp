#include "preprocess/pipeline/up_to_date.h"

#include <sys/stat.h>
#include <sys/xattr.h>

#include <algorithm>
#include <ctime>
#include <string_view>

#include "octree/error.h"
#include "octree/octree_file.h"
#include "preprocess/pipeline/hash.h"

namespace glowworm {
namespace {

constexpr std::time_t kSettled = 2;  // s; coarser than any file system's clock but FAT's

const char* attribute_of(Record record) {
    return record == Record::kState ? "user.glowworm.inputs" : "user.glowworm.content";
}

/// `value` and what the output is now, as a hash; empty where there is neither.
std::string with_output(const std::string& value, const std::filesystem::path& output) {
    struct stat status = {};
    if (value.empty() || ::stat(output.c_str(), &status) != 0) return {};
    return Hash()
        .add(value)
        .add(status.st_size)
        .add(status.st_mtim.tv_sec)
        .add(status.st_mtim.tv_nsec)
        .hex();
}

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

void remember_as(const std::filesystem::path& output, Record record, const std::string& value) {
    const std::string kept = with_output(value, output);
    if (kept.empty()) return;
    // Without the attribute the next run takes longer or is refused, nothing else.
    [[maybe_unused]] const int failed =
        ::setxattr(output.c_str(), attribute_of(record), kept.data(), kept.size(), 0);
}

bool remembers(const std::filesystem::path& output, Record record, const std::string& value) {
    char kept[64];
    const ssize_t size = ::getxattr(output.c_str(), attribute_of(record), kept, sizeof(kept));
    return size > 0 &&
           with_output(value, output) == std::string_view(kept, static_cast<std::size_t>(size));
}

std::string provenance_of(const std::filesystem::path& output) {
    try {
        return std::string(OctreeFile::open(output).view().provenance);
    } catch (const Error&) {
        return {};
    }
}

}  // namespace glowworm
