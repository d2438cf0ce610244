#include "preprocess/read/read_scans.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "octree/error.h"
#include "preprocess/read/append_block.h"
#include "preprocess/read/kept_blocks.h"

namespace glowworm {
namespace {

/// A point of a scan takes a byte of its file at the very least, so a count beyond that is a lie.
std::uint64_t believable(std::uint64_t declared, const std::filesystem::path& path) {
    std::error_code ignored;
    return std::min<std::uint64_t>(declared, std::filesystem::file_size(path, ignored));
}

Scan read_scan(ScanFile& file, const ScanHeader& header, const std::filesystem::path& path,
               ScanCounts& counts) {
    Scan scan;
    scan.file = path;
    scan.T_world_scan = header.T_world_scan;
    scan.has_viewpoint = header.has_viewpoint;
    scan.crs = header.crs;
    reserve_points(believable(header.declared_points, path), header.columns, scan.points);

    KeptBlocks blocks(file, counts);
    PointBlock block;
    while (blocks.next(block)) {
        if (scan.points.empty()) scan.offset = choose_offset(block);
        append_block(block, scan.offset, scan.points);
    }
    scan.offset += header.origin;
    return scan;
}

}  // namespace

std::string why_no_points(const ReadReport& report) {
    ScanCounts all;
    for (const ScanCounts& counts : report.scans) {
        all.not_finite += counts.not_finite;
        all.too_far += counts.too_far;
        all.no_return += counts.no_return;
        all.invalid += counts.invalid;
    }
    if (all.found() == 0) {
        return "is a well-formed " + report.format.name + " file without points; export it again";
    }
    return fmt::format(
        "holds {} points and none of use: {} not finite, {} farther than {:.0g} m, {} at (0,0,0), "
        "{} marked as no return; export it again",
        all.found(), all.not_finite, all.too_far, kFarthestMetres, all.no_return, all.invalid);
}

std::vector<Scan> read_scans(const std::filesystem::path& path, const ReadSettings& settings,
                             ReadReport* report) {
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    ReadReport local;
    ReadReport& said = report != nullptr ? *report : local;
    said = {.format = file->format(), .scans = {}, .notes = {}};

    std::vector<std::pair<std::size_t, Scan>> found;  // with their place in the report
    ScanHeader header;
    while (file->next_scan(header)) {
        ScanCounts& counts = said.scans.emplace_back();
        counts.declared = header.declared_points;
        said.notes.insert(said.notes.end(), header.notes.begin(), header.notes.end());
        Scan scan = read_scan(*file, header, path, counts);
        if (!scan.points.empty()) found.emplace_back(said.scans.size() - 1, std::move(scan));
    }
    for (std::size_t i = 0; i < said.scans.size(); ++i) {
        said.scans[i].name = path.filename().string();
        if (said.scans.size() > 1) said.scans[i].name += "#" + std::to_string(i + 1);
    }
    if (found.empty()) {
        throw Error(ExitCode::kDegenerate, "'" + path.string() + "' " + why_no_points(said));
    }
    std::vector<Scan> scans;
    for (auto& [place, scan] : found) {
        scan.name = said.scans[place].name;
        scans.push_back(std::move(scan));
    }
    return scans;
}

}  // namespace glowworm
