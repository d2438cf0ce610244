#pragma once

#include <filesystem>
#include <span>

#include "preprocess/points.h"
#include "preprocess/write/records.h"

namespace glowworm {

/// Writes a cloud as binary little-endian PLY, the columns that are there in the order x y z
/// (float, relative to the origin) nx ny nz, red green blue (uchar sRGB), intensity, ndf, radius,
/// station (uint), emission_r/g/b, time (double), with origin, stations and lights as comments
/// (cloud_comments.h). read_cloud gives the same cloud back, bit for bit, without the extra
/// columns. Throws Error as AtomicFile.
void write_ply(const PointCloud& cloud, const std::filesystem::path& path,
               std::span<const ExtraColumn> extra = {});

}  // namespace glowworm
