#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// What a light meter reads at a surface point, W·m⁻².
struct Irradiance {
    Vec3f direct;    ///< straight from a light, area lights included
    Vec3f indirect;  ///< reflected at least once
};

struct MeterPoint {
    Vec3d position;  ///< m, world
    Vec3d normal;    ///< unit, world
};

/// A probes.csv: points to measure at, and the columns that are carried through as they are.
struct ProbeTable {
    std::string carried_header;        ///< "px,py,pz,nx,ny,nz,..." without truth columns
    std::vector<std::string> carried;  ///< [n] each row's cells of carried_header
    std::vector<MeterPoint> probes;    ///< [n]
    std::vector<Irradiance> truth;     ///< [n], or empty where the file has none
};

/// Reads a CSV with a header line that has px, py, pz, nx, ny, nz in any order. Columns named like
/// the results are truth to compare with. Throws Error (kUnreadable) with the line's number for a
/// missing column or one that is there twice, a short row, a number that is not finite or a zero
/// normal; (kDegenerate) for a file without rows.
ProbeTable read_probes(const std::filesystem::path& path);

/// The table with the six columns E_direct_r .. E_indirect_b; `measured` is [n].
std::string format_probes(const ProbeTable& table, std::span<const Irradiance> measured);

/// Relative differences |measured − truth| / max(truth, 2 % of the mean truth) over probes and
/// channels.
struct Difference {
    double mean = 0.0, worst = 0.0;
};
struct ProbeDifferences {
    Difference direct, indirect;
};

/// Empty where the table has no truth.
std::optional<ProbeDifferences> compare_probes(const ProbeTable& table,
                                               std::span<const Irradiance> measured);

}  // namespace glowworm
