#pragma once

#include <string>

#include "preprocess/read/las_header.h"

namespace glowworm {

/// The coordinate reference system in words: the WKT record, else the citation and the codes of the
/// GeoTIFF keys ("NAD83 / UTM zone 17N, EPSG:26917, unit EPSG:9001"); empty where nothing is said.
std::string las_crs(const InputFile& file, const LasHeader& header);

}  // namespace glowworm
