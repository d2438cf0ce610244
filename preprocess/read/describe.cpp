#include "preprocess/read/describe.h"

#include <algorithm>
#include <limits>
#include <map>

#include "preprocess/read/append_block.h"
#include "preprocess/read/columns.h"
#include "preprocess/read/kept_blocks.h"

namespace glowworm {
namespace {

struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    void add(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
};

/// By the column's name in our own files.
using Ranges = std::map<std::string, Range, std::less<>>;

template <typename T>
void add_scalars(const std::vector<T>& column, const char* name, Ranges& ranges) {
    if (column.empty()) return;
    Range range;
    for (const T& value : column)
        range.add(static_cast<double>(value));
    Range& all = ranges[name];
    all.add(range.low);
    all.add(range.high);
}

template <typename T>
void add_vectors(const std::vector<Vec3<T>>& column, const char* const (&names)[3],
                 Ranges& ranges) {
    if (column.empty()) return;
    for (int axis = 0; axis < 3; ++axis) {
        Range& range = ranges[names[axis]];
        for (const Vec3<T>& value : column)
            range.add(static_cast<double>(value[axis]));
    }
}

void add_block(const PointBlock& block, Ranges& ranges) {
    add_vectors(block.positions, {"x", "y", "z"}, ranges);
    add_vectors(block.normals, {"nx", "ny", "nz"}, ranges);
    add_vectors(block.emissions, {"emission_r", "emission_g", "emission_b"}, ranges);
    add_scalars(block.intensities, "intensity", ranges);
    add_scalars(block.ndf_lengths, "ndf", ranges);
    add_scalars(block.radii, "radius", ranges);
    add_scalars(block.stations, "station", ranges);
    add_scalars(block.times, "time", ranges);
    for (const GridCell& cell : block.grid) {
        ranges["row"].add(cell.row);
        ranges["column"].add(cell.column);
    }
    for (const Rgb8& c : block.colours) {
        ranges["red"].add(c.r);
        ranges["green"].add(c.g);
        ranges["blue"].add(c.b);
    }
}

std::vector<FieldDescription> fields_of(const ScanHeader& header, const Ranges& ranges) {
    std::vector<FieldDescription> fields;
    for (const FieldHeader& field : header.fields) {
        FieldDescription& described = fields.emplace_back(FieldDescription{.header = field});
        const auto range = ranges.find(field.meaning);
        if (range == ranges.end() || range->second.low > range->second.high) continue;
        described.has_range = true;
        described.low = range->second.low;
        described.high = range->second.high;
    }
    return fields;
}

}  // namespace

ScanFileDescription describe_scan_file(const std::filesystem::path& path,
                                       const ReadSettings& settings) {
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    ScanFileDescription described;
    described.file = path;
    described.format = file->format();
    described.bytes = std::filesystem::file_size(path);

    std::vector<SpacingCollector> spacings;
    PointBlock block;
    ScanHeader header;
    while (file->next_scan(header)) {
        ScanDescription& scan = described.scans.emplace_back();
        scan.header = header;
        scan.facts.counts.declared = header.declared_points;
        scan.facts.has_pose = header.T_world_scan.has_value();
        scan.facts.crs = header.crs;
        FactsCollector collector;
        Ranges ranges;
        KeptBlocks blocks(*file, scan.facts.counts);
        bool chosen = false;
        while (blocks.next(block)) {
            if (block.size() == 0) continue;
            if (!chosen) scan.offset = choose_offset(block);
            chosen = true;
            collector.add(block, header.origin);
            add_block(block, ranges);
        }
        collector.finish(scan.facts);
        scan.offset += header.origin;
        scan.fields = fields_of(header, ranges);
        described.points += scan.facts.counts.kept;
        spacings.emplace_back(collector.spread_points());
    }

    const std::unique_ptr<ScanFile> again = open_scan_file(path, settings);
    std::vector<ScanFacts> facts;
    for (std::size_t i = 0; i < described.scans.size() && again->next_scan(header); ++i) {
        ScanDescription& scan = described.scans[i];
        while (again->next_block(block))
            spacings[i].add(block.positions, header.origin);
        scan.facts.spacing = spacings[i].median();
        scan.facts.counts.name = path.filename().string();
        if (described.scans.size() > 1) scan.facts.counts.name += "#" + std::to_string(i + 1);
        facts.push_back(scan.facts);
    }
    described.warnings = preflight(facts);
    return described;
}

}  // namespace glowworm
