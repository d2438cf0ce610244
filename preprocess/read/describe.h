#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "preprocess/read/preflight.h"
#include "preprocess/read/scan_facts.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// A field of the file and what its values are.
struct FieldDescription {
    FieldHeader header;
    bool has_range = false;        ///< fields that fill no column are not looked at
    double low = 0.0, high = 0.0;  ///< over the points that are finite; positions without origin
};

struct ScanDescription {
    ScanHeader header;  ///< as the file states it: pose, origin, colour bits, CRS, metadata, notes
    ScanFacts facts;    ///< what its points are: counts, bounds, spacing
    std::vector<FieldDescription> fields;
    Vec3d offset;  ///< m, what reading would take out of the positions
};

struct ScanFileDescription {
    std::filesystem::path file;
    ScanFile::Format format;
    std::uint64_t bytes = 0;
    std::uint64_t points = 0;  ///< over all scans, what reading keeps
    std::vector<ScanDescription> scans;
    std::vector<Warning> warnings;  ///< preflight's, of this file alone
};

/// What is in a scan file, for people and scripts. Reads it twice, as a stream. A well-formed file
/// without points is described; throws Error (kUnreadable) as open_scan_file.
ScanFileDescription describe_scan_file(const std::filesystem::path& path,
                                       const ReadSettings& settings = {});

}  // namespace glowworm
