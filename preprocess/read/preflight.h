#pragma once

#include <span>
#include <string>
#include <vector>

#include "preprocess/read/read_scans.h"
#include "preprocess/read/scan_facts.h"
#include "preprocess/scan.h"

namespace glowworm {

/// Something that is allowed but probably not meant, found before hours of work. The ids:
///   colour-black       every colour is zero
///   colour-constant    every point has the same colour
///   colour-invalid     the file marks points as without colour; they got the others' mean
///   intensity-invalid  the same for intensity
///   points-at-origin   more than 1 % were exactly at (0,0,0) and were dropped as "no return"
///   points-not-finite  coordinates that are NaN or infinite were dropped
///   points-too-far     coordinates beyond 1e10 m, how programs write "no value", were dropped
///   points-missing     the file holds another number of points than it announces
///   points-duplicate   more than 1 % lie exactly where another one does
///   units-degrees      the coordinates look like degrees of longitude and latitude
///   units-feet         the coordinate system, or its heights alone, is in feet
///   units-too-large    the scan is larger than 5 km: millimetres perhaps
///   units-too-small    the scan is smaller than 5 cm: kilometres perhaps
///   float-lost         far coordinates were stored as 32-bit floats, millimetres are lost
///   float-range        so large that positions as 32-bit floats miss a millimetre
///   pose-missing       no pose, while other scans have one
///   spacing-apart      points 10 times as far apart as in another scan, or more
struct Warning {
    std::string id;        ///< stable, for scripts: "colour-constant"
    std::string file;      ///< the scan's name
    std::string sentence;  ///< what it is and what to do
};

/// Looks at what was read for what people meant otherwise. Empty in, empty out.
std::vector<Warning> preflight(std::span<const ScanFacts> scans);

/// The same for scans in memory. `reports` are those of read_scans, in any order; what was dropped
/// is only known with them.
std::vector<Warning> preflight(std::span<const Scan> scans,
                               std::span<const ReadReport> reports = {});

}  // namespace glowworm
