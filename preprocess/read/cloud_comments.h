#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "octree/surfel.h"
#include "octree/vec3.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// What a merged cloud says beside its points. In PLY each is a `comment` line, in PCD a `#` line:
///
///     origin X Y Z
///     station INDEX X Y Z QX QY QZ QW HAS_VIEWPOINT NAME
///     area_light X1 Y1 Z1 X2 Y2 Z2 X3 Y3 Z3 X4 Y4 Z4 R G B NAME
///
/// Lengths are metres in the world (not relative to the origin), numbers have as many digits as it
/// takes to read the same double back, HAS_VIEWPOINT is 0 or 1, INDEX counts from 0 and is what the
/// points' `station` refers to, R G B is the radiance in W·sr⁻¹·m⁻², NAME is the rest of the line
/// and may be empty. In NAME control characters, '%', and spaces at either end are written as
/// %XX, two hexadecimal digits.
struct CloudComments {
    Vec3d origin;
    std::vector<Station> stations;
    std::vector<AreaLight> area_lights;
};

/// The lines for a cloud, without `comment ` and without line ends. The origin's is always there.
std::vector<std::string> write_cloud_comments(const CloudComments& comments);

/// Takes in one line. False, and nothing changed, where the line is no such comment (as comments of
/// other programs are): wrong number of words, a number that is not finite, or a station whose
/// INDEX is not the number of stations so far.
bool read_cloud_comment(std::string_view line, CloudComments& comments);

/// Reads all comments of a file into `header`: origin, stations and area lights where they say so,
/// the others into its metadata as "comment".
void read_cloud_comments(std::span<const std::string> comments, ScanHeader& header);

}  // namespace glowworm
