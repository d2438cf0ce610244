#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "octree/surfel.h"
#include "octree/vec3.h"
#include "preprocess/points.h"

namespace glowworm {

struct ReadSettings {
    bool check_crc = true;  ///< E57: stop at a page whose checksum is wrong; false salvages
    std::string columns;    ///< text: what the columns mean, "x y z intensity r g b"; "-" skips
                            ///< one; empty: worked out from the header line and the values
    char delimiter = '\0';  ///< text: between the columns; 0: worked out
};

/// Which columns the blocks of a scan have besides positions.
struct ColumnSet {
    bool normals = false, colours = false, intensities = false, ndf_lengths = false, radii = false,
         stations = false, emissions = false, times = false, grid = false;
};

/// Up to about 64 k points as columns: the unit in which files are read. A column is either empty
/// or as long as `positions`.
struct PointBlock {
    std::vector<Vec3d> positions;         ///< m, in the scan's own frame, without its origin
    std::vector<Vec3f> normals;           ///< as in the file; not necessarily unit
    std::vector<Rgb8> colours;            ///< sRGB
    std::vector<float> intensities;       ///< the scanner's own scale
    std::vector<float> ndf_lengths;       ///< Toksvig length in (0, 1]
    std::vector<float> radii;             ///< m
    std::vector<std::uint32_t> stations;  ///< index of the scan it was seen from
    std::vector<Vec3f> emissions;         ///< radiance, W·sr⁻¹·m⁻²
    std::vector<double> times;            ///< s, the scanner's own clock
    std::vector<GridCell> grid;           ///< of organised scans
    std::uint64_t invalid = 0;            ///< points the file itself marks as no return: left out
    std::uint64_t no_colour = 0;          ///< marked as without colour: missing_values.h
    std::uint64_t no_intensity = 0;       ///< likewise

    std::size_t size() const { return positions.size(); }

    /// Makes the columns of `columns` `count` long and all others empty. Memory is kept, and what
    /// is in a column afterwards is meant to be overwritten.
    void resize(std::size_t count, const ColumnSet& columns);
};

/// A field of the file as the file names it.
struct FieldHeader {
    std::string name;     ///< "scalar_Intensity"
    std::string type;     ///< "float32", "uint16", "text"
    std::string meaning;  ///< the column it fills ("intensity"), empty where it is passed over
};

/// What a file says about a scan before its points.
struct ScanHeader {
    std::string name;                   ///< empty where the file has none
    std::uint64_t declared_points = 0;  ///< records announced, 0 where nothing is
    ColumnSet columns;
    std::optional<Eigen::Isometry3d> T_world_scan;  ///< the pose the file carries
    bool has_viewpoint = false;  ///< the format says that the scanner stood at the frame's origin
    Vec3d origin;                ///< m, to be added to every position
    int colour_bits = 0;         ///< of a channel in the file: 8, 16, 32 (float), 0 without colour
    std::string crs;             ///< coordinate reference system as text, empty where there is none
    std::vector<FieldHeader> fields;
    std::vector<Station> stations;       ///< of a merged cloud; PointBlock::stations points here
    std::vector<AreaLight> area_lights;  ///< of a lit cloud
    std::vector<std::pair<std::string, std::string>> metadata;  ///< whatever else the file says
    std::vector<std::string> notes;  ///< full sentences: what was worked out rather than stated
};

/// A file of scans, read as a stream: memory does not depend on the size of the file (but for
/// compressed PCD, whose columns lie one after the other). All members throw Error: kUnreadable for
/// what is damaged, truncated or unsupported. A count in a header is believed only as far as the
/// bytes for it are there.
class ScanFile {
  public:
    virtual ~ScanFile() = default;

    struct Format {
        std::string name;     ///< "PLY"
        std::string version;  ///< "1.0 binary_little_endian"
    };
    virtual Format format() const = 0;

    /// Steps to the next scan, passing over what is left of the one before. False, and `header`
    /// untouched, after the last.
    virtual bool next_scan(ScanHeader& header) = 0;

    /// Replaces `block` by the next points of the scan. False, and `block` empty, after the last.
    /// A block may be without points where all of them were invalid.
    virtual bool next_block(PointBlock& block) = 0;
};

/// Opens a file by its content, whatever its name. Throws Error (kUnreadable) for what is missing,
/// empty, no regular file, not recognised, or of a vendor's closed format.
std::unique_ptr<ScanFile> open_scan_file(const std::filesystem::path& path,
                                         const ReadSettings& settings = {});

}  // namespace glowworm
