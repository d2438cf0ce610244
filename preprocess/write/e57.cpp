#include "preprocess/write/e57.h"

#include <xxhash.h>

#include <algorithm>
#include <cstring>

#include "octree/atomic_file.h"
#include "preprocess/read/e57_pages.h"
#include "preprocess/read/little_endian.h"
#include "preprocess/write/e57_layout.h"
#include "preprocess/write/e57_page_writer.h"

namespace glowworm {
namespace {

void write_header(E57PageWriter& out, std::uint64_t xml_at, std::uint64_t xml_bytes) {
    const std::uint64_t pages = (xml_at + xml_bytes + kE57PayloadBytes - 1) / kE57PayloadBytes;
    std::byte header[kE57HeaderBytes] = {};
    std::memcpy(header, "ASTM-E57", 8);
    store(header + 8, std::uint32_t{1});
    store(header + 12, std::uint32_t{0});
    store(header + 16, pages * kE57PageBytes);
    store(header + 24, e57_physical(xml_at));
    store(header + 32, xml_bytes);
    store(header + 40, kE57PageBytes);
    out.write(header, sizeof(header));
}

void write_section_header(E57PageWriter& out, const E57ScanLayout& scan) {
    std::byte head[kE57SectionHeadBytes] = {};
    head[0] = std::byte{1};
    store(head + 8, kE57SectionHeadBytes + scan.content_bytes());
    store(head + 16, e57_physical(scan.section + kE57SectionHeadBytes));
    // No index packet: libE57 never asked for one, and the version in FreeCAD 0.20 fails at any.
    out.write(head, sizeof(head));
}

/// Points [first, first + count) of the scan as one data packet: a run of values per field.
void fill_packet(const PointCloud& cloud, const E57ScanLayout& scan, std::size_t first,
                 std::size_t count, std::vector<std::byte>& packet) {
    const Points& points = cloud.points;
    std::byte* at = packet.data();
    at[0] = std::byte{1};
    store(at + 2, static_cast<std::uint16_t>(packet.size() - 1));
    store(at + 4, static_cast<std::uint16_t>(scan.field_count()));
    std::byte* size = at + 6;
    at += 6 + 2 * scan.field_count();

    const auto add = [&](std::size_t bytes, const auto& write_value) {
        store(size, static_cast<std::uint16_t>(bytes * count));
        size += 2;
        for (std::size_t i = 0; i < count; ++i, at += bytes) {
            write_value(at, scan.indices[first + i]);
        }
    };
    for (int axis = 0; axis < 3; ++axis) {
        add(scan.doubles ? 8 : 4, [&](std::byte* to, std::uint32_t i) {
            const Vec3d world = cloud.origin + vec3_cast<double>(points.positions[i]);
            const double value = to_station(scan.station, world)[axis];
            if (scan.doubles) {
                store(to, value);
            } else {
                store(to, static_cast<float>(value));
            }
        });
    }
    if (scan.colours) {
        add(1, [&](std::byte* to, std::uint32_t i) { store(to, points.colours[i].r); });
        add(1, [&](std::byte* to, std::uint32_t i) { store(to, points.colours[i].g); });
        add(1, [&](std::byte* to, std::uint32_t i) { store(to, points.colours[i].b); });
    }
    if (scan.intensities) {
        add(4, [&](std::byte* to, std::uint32_t i) { store(to, points.intensities[i]); });
    }
    for (int axis = 0; scan.normals && axis < 3; ++axis) {
        add(4, [&](std::byte* to, std::uint32_t i) {
            const Vec3d normal = vec3_cast<double>(points.normals[i]);
            store(to, static_cast<float>(rotate_to_station(scan.station, normal)[axis]));
        });
    }
    if (scan.times) {
        add(8, [&](std::byte* to, std::uint32_t i) { store(to, points.times[i]); });
    }
    if (scan.grid) {
        add(4, [&](std::byte* to, std::uint32_t i) { store(to, points.grid[i].row); });
        add(4, [&](std::byte* to, std::uint32_t i) { store(to, points.grid[i].column); });
    }
}

}  // namespace

void write_e57(const PointCloud& cloud, const std::filesystem::path& path) {
    AtomicFile file(path);
    const std::vector<E57ScanLayout> scans = lay_out_e57(cloud, path.stem().string());
    const std::uint64_t hash =
        XXH3_64bits(cloud.points.positions.data(), cloud.points.positions.size() * sizeof(Vec3f));
    const std::string xml = e57_description(scans, hash);

    E57PageWriter out(file);
    const E57ScanLayout& last = scans.back();
    write_header(out, last.section + kE57SectionHeadBytes + last.content_bytes(), xml.size());
    std::vector<std::byte> packet;
    for (const E57ScanLayout& scan : scans) {
        write_section_header(out, scan);
        for (std::size_t i = 0; i < scan.packet_count(); ++i) {
            const std::size_t first = i * scan.packet_records();
            packet.assign(scan.packet_bytes(i), std::byte{0});
            fill_packet(cloud, scan, first,
                        std::min(scan.packet_records(), scan.indices.size() - first), packet);
            out.write(packet.data(), packet.size());
        }
    }
    out.write(xml.data(), xml.size());
    out.finish();
    file.commit();
}

}  // namespace glowworm
