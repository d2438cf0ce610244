#pragma once

#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>

namespace glowworm {

/// A point of a binary PLY as the benches write it: metres, sRGB bytes.
#pragma pack(push, 1)
struct PlyPoint {
    float position[3], normal[3];
    std::uint8_t colour[3];
    float radius;
};
#pragma pack(pop)

/// Writes what goes before `count` of them.
inline void write_ply_header(std::ostream& stream, std::size_t count) {
    stream << "ply\nformat binary_little_endian 1.0\nelement vertex " << count
           << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\n"
              "property float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\n"
              "property uchar blue\nproperty float radius\nend_header\n";
}

inline void write_ply_points(std::ostream& stream, std::span<const PlyPoint> points) {
    stream.write(reinterpret_cast<const char*>(points.data()),
                 static_cast<std::streamsize>(points.size_bytes()));
}

}  // namespace glowworm
