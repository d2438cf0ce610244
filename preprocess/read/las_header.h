#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "octree/vec3.h"
#include "preprocess/read/input_file.h"

namespace glowworm {

/// A variable length record, before or after the points.
struct LasRecord {
    std::string user;  ///< "LASF_Projection"
    std::uint16_t id = 0;
    std::uint64_t offset = 0;  ///< of its content in the file
    std::uint64_t bytes = 0;
};

/// What extra bytes of a point hold: a number that is `scale` * stored + `offset`.
struct LasExtraField {
    std::string name;            ///< "NormalX"
    std::string type;            ///< "float32"
    std::uint8_t code = 0;       ///< of the type in the file, 1..10; 0: bytes without a type
    std::uint32_t position = 0;  ///< in a point record
    std::uint32_t bytes = 0;
    double scale = 1.0, offset = 0.0;

    /// Its value in `record`; 0 where it has no type.
    double value(const std::byte* record) const;
};

/// Header of a LAS file, versions 1.0 to 1.4 (ASPRS LAS Specification 1.4 R15).
struct LasHeader {
    int version_minor = 0;           ///< of 1.x
    std::uint16_t encoding = 0;      ///< bit 0: times are GPS standard, not GPS week; bit 4: WKT
    std::string system, software;    ///< what made the points and the file
    std::string created;             ///< "2012 day 225", empty where not said
    std::uint32_t point_format = 0;  ///< 0..10
    bool compressed = false;         ///< LAZ
    std::uint32_t record_bytes = 0;  ///< of a point, extra bytes included
    std::uint64_t point_count = 0;
    std::uint64_t point_offset = 0;  ///< bytes from the file's start
    Vec3d scale, offset;             ///< m: coordinate = scale * stored + offset
    Vec3d bounds_min, bounds_max;    ///< m, as the writer says
    std::vector<LasRecord> records;
    std::vector<LasExtraField> extra_fields;
    std::string crs;                 ///< WKT, or what the GeoTIFF keys say in words
    std::vector<std::string> notes;  ///< full sentences: damage that leaves the points readable
};

/// Where the parts of a point lie in its record; 0 where the format has none.
struct LasPointFormat {
    std::uint32_t bytes;     ///< without extra bytes
    std::uint32_t gps_time;  ///< double
    std::uint32_t colour;    ///< 3 x uint16
    std::uint32_t flags;     ///< the byte with the withheld bit
    std::uint8_t withheld;   ///< that bit
};

/// For point formats 0 to 10.
const LasPointFormat& las_point_format(std::uint32_t point_format);

/// Reads header and records. Throws Error (kUnreadable) for what is damaged, truncated or of an
/// unknown version or point format; a wrong number of records is a note.
LasHeader read_las_header(const InputFile& file);

/// The content of the first record of `user` and `id`; empty where there is none or it is longer
/// than 1 MiB.
std::vector<std::byte> read_las_record(const InputFile& file, const LasHeader& header,
                                       const std::string& user, std::uint16_t id);

}  // namespace glowworm
