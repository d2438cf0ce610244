#include "preprocess/write/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "octree/atomic_file.h"
#include "preprocess/read/cloud_comments.h"
#include "preprocess/write/records.h"

namespace glowworm {

void write_ply(const PointCloud& cloud, const std::filesystem::path& path,
               std::span<const ExtraColumn> extra) {
    constexpr std::size_t kBlockPoints = 65536;
    const Points& points = cloud.points;
    AtomicFile file(path);

    std::string header = "ply\nformat binary_little_endian 1.0\n";
    for (const std::string& line :
         write_cloud_comments({cloud.origin, cloud.stations, cloud.area_lights})) {
        header += "comment " + line + "\n";
    }
    header += fmt::format("element vertex {}\n", points.size());
    for (const WrittenField& field : written_fields(points, ColourForm::kThreeBytes, extra)) {
        header += fmt::format("property {} {}\n", field.type, field.name);
    }
    file.write(header + "end_header\n");

    for (std::size_t begin = 0; begin < points.size(); begin += kBlockPoints) {
        const std::size_t end = std::min(begin + kBlockPoints, points.size());
        const std::vector<std::byte> records =
            write_records(points, ColourForm::kThreeBytes, begin, end, extra);
        file.write(records.data(), records.size());
    }
    file.commit();
}

}  // namespace glowworm
