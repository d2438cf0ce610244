#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "octree/progress.h"
#include "preprocess/read/scan_file.h"
#include "preprocess/scan.h"

namespace glowworm {

/// What became of the points of one scan.
struct ScanCounts {
    std::string name;            ///< as Scan::name
    std::uint64_t declared = 0;  ///< records its header announces, 0 where it announces none
    std::uint64_t kept = 0;
    std::uint64_t not_finite = 0;    ///< dropped: a coordinate that is NaN or infinite
    std::uint64_t too_far = 0;       ///< dropped: a coordinate beyond kFarthestMetres
    std::uint64_t no_return = 0;     ///< dropped: exactly at the frame's origin, and more than one
    std::uint64_t invalid = 0;       ///< dropped: marked so by the file
    std::uint64_t no_colour = 0;     ///< marked so by the file: they got the colour of the others
    std::uint64_t no_intensity = 0;  ///< likewise

    /// Points that were there, kept or not.
    std::uint64_t found() const { return kept + not_finite + too_far + no_return + invalid; }
};

struct ReadReport {
    ScanFile::Format format;
    std::vector<ScanCounts> scans;   ///< those without points included
    std::vector<std::string> notes;  ///< full sentences: what was worked out rather than stated
};

/// Why nothing is left of a file: "is a well-formed PLY file without points; export it again", or
/// what its points were dropped for.
std::string why_no_points(const ReadReport& report);

/// The scan files among what the user named, in that order: files as they are, a folder replaced by
/// the scan files in it (one level, by content, "scan2" before "scan10"). Throws Error: kUnreadable
/// for a path that is not there or a folder without scans, kUsage for the same file twice.
std::vector<std::filesystem::path> find_scan_files(
    std::span<const std::filesystem::path> files_or_folders);

/// Reads every scan of a file, each in its own frame. Its name is the file's, with "#1", "#2" … in
/// a file that holds several. Coordinates beyond 1 km have whole metres taken out as the scan's
/// offset before they become float. Points that are not finite or absurdly far (append_block.h),
/// and points exactly at the frame's origin where there is more than one (how scanners write "no
/// return"), are dropped and counted; a single one comes last. Throws Error: kUnreadable as
/// open_scan_file, kDegenerate where no points are left.
std::vector<Scan> read_scans(const std::filesystem::path& path, const ReadSettings& settings = {},
                             ReadReport* report = nullptr);

/// Reads a merged cloud or surfels with every column that is there: ours with origin, stations and
/// lights (cloud_comments.h), others' as they are. Several scans, or one with a pose, are taken to
/// the world and become stations. Nothing but points that are not finite or absurdly far is
/// dropped. Throws Error: kUnreadable as open_scan_file and for a point whose station is not there,
/// kDegenerate where no points are left. `progress` counts points.
PointCloud read_cloud(const std::filesystem::path& path, const ReadSettings& settings = {},
                      ReadReport* report = nullptr, const Progress& progress = {});

}  // namespace glowworm
