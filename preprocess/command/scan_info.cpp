#include "preprocess/command/scan_info.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <numbers>
#include <optional>

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
    const ScanCounts& counts = facts.counts;
    Json json = {{"name", counts.name},
                 {"title", scan.header.name},
                 {"declared", scan.header.declared_points},
                 {"points", counts.kept},
                 {"not_finite", counts.not_finite},
                 {"too_far", counts.too_far},
                 {"invalid", counts.invalid},
                 {"no_return", counts.no_return},
                 {"no_colour", counts.no_colour},
                 {"no_intensity", counts.no_intensity}};
    if (facts.counts.kept > 0) {
        json["bounds"] = {{"min", vector_json(facts.low)}, {"max", vector_json(facts.high)}};
    }
    json["spacing"] = facts.spacing;
    json["offset"] = vector_json(scan.offset);
    json["colour_bits"] = scan.header.colour_bits;
    json["T_world_scan"] = pose_json(scan.header.T_world_scan);
    json["crs"] = scan.header.crs;
    json["grid"] = nullptr;
    if (facts.grid_rows > 0) {
        json["grid"] = {{"rows", facts.grid_rows}, {"columns", facts.grid_columns}};
    }
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

std::string distance(double metres) {
    return metres < 1.0 ? fmt::format("{:.1f} mm", metres * 1e3) : fmt::format("{:.2f} m", metres);
}

/// " (3 not finite, 1 no return)", or nothing where nothing was left out.
std::string left_out(const ScanCounts& counts) {
    std::string words;
    const auto add = [&](std::uint64_t count, const char* what) {
        if (count > 0)
            words += fmt::format("{}{} {}", words.empty() ? "" : ", ", format_count(count), what);
    };
    add(counts.not_finite, "not finite");
    add(counts.too_far, "absurdly far");
    add(counts.no_return, "at the origin");
    add(counts.invalid, "marked invalid");
    return words.empty() ? "" : " (left out: " + words + ")";
}

std::string pose_words(const std::optional<Eigen::Isometry3d>& pose) {
    if (!pose) return "none";
    const Eigen::Vector3d at = pose->translation();
    const double turn = Eigen::AngleAxisd(pose->linear()).angle() * 180.0 / std::numbers::pi;
    return fmt::format("at {:.3f} {:.3f} {:.3f} m, turned by {:.2f} degrees", at.x(), at.y(),
                       at.z(), turn);
}

void print(const ScanDescription& scan) {
    const ScanFacts& facts = scan.facts;
    fmt::print("\nscan        {}", facts.counts.name);
    if (!scan.header.name.empty()) fmt::print(", \"{}\"", scan.header.name);
    fmt::print("\npoints      {}{}\n", format_count(facts.counts.kept), left_out(facts.counts));
    if (facts.counts.kept > 0) {
        fmt::print("bounds      {:.3f} {:.3f} {:.3f} to {:.3f} {:.3f} {:.3f} m\n", facts.low.x,
                   facts.low.y, facts.low.z, facts.high.x, facts.high.y, facts.high.z);
        if (facts.spacing > 0.0) fmt::print("spacing     {}\n", distance(facts.spacing));
    }
    if (scan.offset != Vec3d{}) {
        fmt::print("offset      {:.0f} {:.0f} {:.0f} m, taken out of the points\n", scan.offset.x,
                   scan.offset.y, scan.offset.z);
    }
    fmt::print("pose        {}\n", pose_words(scan.header.T_world_scan));
    if (facts.grid_rows > 0) {
        fmt::print("grid        {} rows, {} columns\n", format_count(facts.grid_rows),
                   format_count(facts.grid_columns));
    }
    if (scan.header.colour_bits > 0) fmt::print("colour      {} bits\n", scan.header.colour_bits);
    for (const auto& [key, value] : scan.header.metadata)
        fmt::print("{:<11} {}\n", key, value);
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
