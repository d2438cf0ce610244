#pragma once

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "preprocess/clean.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/station.h"

namespace glowworm::testing {

/// The one scan of a file.
inline Scan load(const std::filesystem::path& file) {
    return read_scans(file).at(0);
}

/// The scans of these files, their viewpoints told, outliers removed: as the pipeline prepares
/// them.
inline std::vector<Scan> load_clean(const std::filesystem::path& folder,
                                    const std::vector<std::string>& names) {
    std::vector<Scan> scans;
    for (const std::string& name : names) {
        Scan scan = load(folder / name);
        scan.has_viewpoint = origin_is_viewpoint(scan.points);
        scan.points = clean(scan.points, scan.has_viewpoint, {});
        scans.push_back(std::move(scan));
    }
    return scans;
}

inline std::set<std::uint32_t> load_indices(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::set<std::uint32_t> indices;
    for (std::uint32_t i = 0; in >> i;)
        indices.insert(i);
    return indices;
}

}  // namespace glowworm::testing
