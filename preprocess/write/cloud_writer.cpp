#include "preprocess/write/cloud_writer.h"

#include <string>
#include <string_view>

#include "octree/error.h"
#include "preprocess/write/e57.h"
#include "preprocess/write/las.h"
#include "preprocess/write/pcd.h"
#include "preprocess/write/ply.h"

namespace glowworm {
namespace {

struct CloudWriter {
    std::string_view extension;
    void (*write)(const PointCloud& cloud, const std::filesystem::path& path,
                  std::span<const ExtraColumn> extra);
};

constexpr CloudWriter kWriters[] = {
    {".ply", write_ply},
    {".pcd", [](auto& cloud, auto& path, auto) { write_pcd(cloud, path); }},
    {".las", [](auto& cloud, auto& path, auto) { write_las(cloud, path); }},
    {".e57", [](auto& cloud, auto& path, auto) { write_e57(cloud, path); }},
};

const CloudWriter& writer_for(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    std::string known;
    for (const CloudWriter& writer : kWriters) {
        if (writer.extension == extension) return writer;
        known += (known.empty() ? "" : ", ") + std::string(writer.extension);
    }
    throw Error(ExitCode::kUsage, "cannot write '" + path.string() +
                                      "': its extension names no format; use one of " + known);
}

}  // namespace

void write_cloud(const PointCloud& cloud, const std::filesystem::path& path,
                 std::span<const ExtraColumn> extra) {
    writer_for(path).write(cloud, path, extra);
}

void check_cloud_extension(const std::filesystem::path& path) {
    writer_for(path);
}

}  // namespace glowworm
