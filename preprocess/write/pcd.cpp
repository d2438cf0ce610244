#include "preprocess/write/pcd.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "octree/atomic_file.h"
#include "preprocess/read/cloud_comments.h"
#include "preprocess/write/records.h"

namespace glowworm {
namespace {

std::string pcd_name(std::string_view name) {
    const bool normal = name == "nx" || name == "ny" || name == "nz";
    return normal ? "normal_" + std::string(name.substr(1)) : std::string(name);
}

char pcd_type(std::string_view type) {
    return type == "uint" ? 'U' : 'F';
}

}  // namespace

void write_pcd(const PointCloud& cloud, const std::filesystem::path& path) {
    constexpr std::size_t kBlockPoints = 65536;
    const Points& points = cloud.points;
    AtomicFile file(path);

    std::string header = "# .PCD v0.7 - Point Cloud Data file format\n";
    for (const std::string& line :
         write_cloud_comments({cloud.origin, cloud.stations, cloud.area_lights})) {
        header += "# " + line + "\n";
    }
    std::string names = "FIELDS", sizes = "SIZE", types = "TYPE", counts = "COUNT";
    for (const WrittenField& field : written_fields(points, ColourForm::kPacked)) {
        names += " " + pcd_name(field.name);
        sizes += fmt::format(" {}", field.bytes);
        types += fmt::format(" {}", pcd_type(field.type));
        counts += " 1";
    }
    header += fmt::format(
        "VERSION 0.7\n{}\n{}\n{}\n{}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\n"
        "POINTS {}\nDATA binary\n",
        names, sizes, types, counts, points.size(), points.size());
    file.write(header);

    for (std::size_t begin = 0; begin < points.size(); begin += kBlockPoints) {
        const std::size_t end = std::min(begin + kBlockPoints, points.size());
        const std::vector<std::byte> records =
            write_records(points, ColourForm::kPacked, begin, end);
        file.write(records.data(), records.size());
    }
    file.commit();
}

}  // namespace glowworm
