#include "preprocess/command/scan_info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "preprocess/command/stage_flags.h"
#include "preprocess/read/describe.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Vec3d& v) {
    return {v.x, v.y, v.z};
}

Json pose_json(const std::optional<Eigen::Isometry3d>& pose) {
    if (!pose) return nullptr;
    Json numbers = Json::array();
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column)
            numbers.push_back(pose->matrix()(row, column));
    }
    return numbers;
}

Json fields_json(const ScanDescription& scan) {
    Json fields = Json::array();
    for (const FieldDescription& field : scan.fields) {
        Json entry = {{"name", field.header.name},
                      {"type", field.header.type},
                      {"meaning", field.header.meaning}};
        if (field.has_range) entry["range"] = {field.low, field.high};
        fields.push_back(std::move(entry));
    }
    return fields;
}

Json scan_json(const ScanDescription& scan) {
    const ScanFacts& facts = scan.facts;
    Json json = {{"name", facts.counts.name},       {"declared", scan.header.declared_points},
                 {"points", facts.counts.kept},     {"not_finite", facts.counts.not_finite},
                 {"invalid", facts.counts.invalid}, {"no_return", facts.counts.no_return}};
    if (facts.counts.kept > 0) {
        json["bounds"] = {{"min", vector_json(facts.low)}, {"max", vector_json(facts.high)}};
    }
    json["spacing"] = facts.spacing;
    json["offset"] = vector_json(scan.offset);
    json["colour_bits"] = scan.header.colour_bits;
    json["T_world_scan"] = pose_json(scan.header.T_world_scan);
    json["crs"] = scan.header.crs;
    json["fields"] = fields_json(scan);
    json["metadata"] = Json::object();
    for (const auto& [key, value] : scan.header.metadata)
        json["metadata"][key] = value;
    json["notes"] = scan.header.notes;
    return json;
}

Json to_json(const ScanFileDescription& file) {
    Json scans = Json::array();
    for (const ScanDescription& scan : file.scans)
        scans.push_back(scan_json(scan));
    return {{"file", file.file.string()},
            {"format", file.format.name},
            {"version", file.format.version},
            {"bytes", file.bytes},
            {"points", file.points},
            {"scans", scans},
            {"warnings", warnings_json(file.warnings)}};
}

void print(const ScanDescription& scan) {
    const ScanFacts& facts = scan.facts;
    fmt::print("\nscan        {}\n", facts.counts.name);
    fmt::print("points      {} ({} not finite, {} invalid)\n", format_count(facts.counts.kept),
               format_count(facts.counts.not_finite), format_count(facts.counts.invalid));
    if (facts.counts.kept > 0) {
        fmt::print("bounds      {:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f} m\n", facts.low.x,
                   facts.low.y, facts.low.z, facts.high.x, facts.high.y, facts.high.z);
        fmt::print("spacing     {:.1f} mm\n", facts.spacing * 1e3);
    }
    fmt::print("pose        {}\n", scan.header.T_world_scan ? "in the file" : "none");
    if (scan.header.colour_bits > 0) fmt::print("colour      {} bits\n", scan.header.colour_bits);
    if (!scan.header.crs.empty()) fmt::print("CRS         {}\n", scan.header.crs);
    for (const FieldDescription& field : scan.fields) {
        fmt::print("field       {:<20} {:<10} {:<12}", field.header.name, field.header.type,
                   field.header.meaning.empty() ? "passed over" : field.header.meaning);
        if (field.has_range) fmt::print(" {:.6g} to {:.6g}", field.low, field.high);
        fmt::print("\n");
    }
    for (const std::string& note : scan.header.notes)
        fmt::print("note        {}\n", note);
}

}  // namespace

Json scan_info(const std::filesystem::path& path, const ReadSettings& settings, Run& run) {
    const ScanFileDescription file = describe_scan_file(path, settings);
    if (!run.flags.json) {
        fmt::print("{}: {} {}, {}, {}, {}\n", path.string(), file.format.name, file.format.version,
                   format_bytes(file.bytes), format_number_of(file.points, "point"),
                   format_number_of(file.scans.size(), "scan"));
        for (const ScanDescription& scan : file.scans)
            print(scan);
    }
    say_warnings(file.warnings);
    return to_json(file);
}

}  // namespace glowworm
