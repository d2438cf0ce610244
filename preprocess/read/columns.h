#pragma once

#include <cstdint>
#include <string_view>

#include "preprocess/read/scan_file.h"

namespace glowworm {

/// What one value of a point means.
enum class Column : std::uint8_t {
    kNone,  ///< passed over
    kX,
    kY,
    kZ,
    kNormalX,
    kNormalY,
    kNormalZ,
    kRed,
    kGreen,
    kBlue,
    kPackedRgb,  ///< 0x..RRGGBB in an integer or in the bits of a float, as PCL has it
    kIntensity,
    kNdf,
    kRadius,
    kStation,
    kEmissionR,
    kEmissionG,
    kEmissionB,
    kTime,
};

/// The column that a property, field or header word of this name holds, however its writer spells
/// it: "x", "X", "//X", "normal_x", "diffuse_red", "R", "scalar_Intensity", "GpsTime".
/// kNone where the name is not known.
Column column_named(std::string_view name);

/// The name of a column in our own files: "x", "nx", "red", "intensity"; "" for kNone.
std::string_view column_name(Column column);

}  // namespace glowworm
