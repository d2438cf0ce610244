#include "preprocess/read/read_scans.h"

#include <algorithm>
#include <utility>

#include "octree/error.h"
#include "preprocess/read/append_block.h"

namespace glowworm {
namespace {

/// A point of a scan takes a byte of its file at the very least, so a count beyond that is a lie.
std::uint64_t believable(std::uint64_t declared, const std::filesystem::path& path) {
    std::error_code ignored;
    return std::min<std::uint64_t>(declared, std::filesystem::file_size(path, ignored));
}

void erase_point(Points& points, std::size_t index) {
    const auto erase = [&](auto& column) {
        if (!column.empty()) column.erase(column.begin() + static_cast<std::ptrdiff_t>(index));
    };
    erase(points.positions);
    erase(points.normals);
    erase(points.colours);
    erase(points.intensities);
    erase(points.ndf_lengths);
    erase(points.radii);
    erase(points.stations);
    erase(points.emissions);
    erase(points.times);
}

Scan read_scan(ScanFile& file, const ScanHeader& header, const std::filesystem::path& path,
               ScanCounts& counts) {
    Scan scan;
    scan.file = path;
    scan.T_world_scan = header.T_world_scan;
    scan.has_viewpoint = header.has_viewpoint;
    reserve_points(believable(header.declared_points, path), header.columns, scan.points);

    std::uint64_t at_origin = 0;
    std::size_t first_at_origin = 0;  // stays until there is a second one
    PointBlock block;
    while (file.next_block(block)) {
        counts.invalid += block.invalid;
        counts.not_finite += drop_not_finite(block);
        const auto found = std::ranges::find(block.positions, Vec3d{});
        if (found != block.positions.end()) {
            if (at_origin == 0) {
                first_at_origin =
                    scan.points.size() + static_cast<std::size_t>(found - block.positions.begin());
            }
            const std::uint64_t keep = at_origin == 0 ? 1 : 0;
            at_origin += keep + drop_at_origin(block, keep);
        }
        if (scan.points.empty()) scan.offset = choose_offset(block);
        append_block(block, scan.offset, scan.points);
    }
    if (at_origin > 1) {
        erase_point(scan.points, first_at_origin);
        counts.no_return = at_origin;
    }
    scan.offset += header.origin;
    counts.kept = scan.points.size();
    return scan;
}

}  // namespace

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
        throw Error(ExitCode::kDegenerate, "'" + path.string() + "' is a well-formed " +
                                               said.format.name +
                                               " file without points; export the scan again");
    }
    std::vector<Scan> scans;
    for (auto& [place, scan] : found) {
        scan.name = said.scans[place].name;
        scans.push_back(std::move(scan));
    }
    return scans;
}

}  // namespace glowworm
