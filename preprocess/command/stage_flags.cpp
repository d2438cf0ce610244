#include "preprocess/command/stage_flags.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <string_view>
#include <utility>

#include "octree/error.h"
#include "octree/links.h"
#include "octree/scene.h"
#include "preprocess/command/command.h"

namespace glowworm {
namespace {

/// The character that --delimiter means. Throws kUsage for a word that is none.
char delimiter_named(const std::string& word) {
    constexpr std::pair<std::string_view, char> kNames[] = {
        {"space", ' '}, {"spaces", ' '}, {"tab", '\t'},      {"tabs", '\t'},
        {"\\t", '\t'},  {"comma", ','},  {"semicolon", ';'},
    };
    for (const auto& [name, character] : kNames) {
        if (word == name) return character;
    }
    const bool part_of_numbers =
        word.size() == 1 && std::string_view("+-.eE").find(word[0]) != std::string_view::npos;
    const bool printable =
        word.size() == 1 && (word[0] == '\t' || (word[0] >= ' ' && word[0] <= '~'));
    if (!printable || part_of_numbers || (word[0] >= '0' && word[0] <= '9')) {
        throw Error(ExitCode::kUsage,
                    fmt::format("--delimiter '{}' parts no numbers; give space, tab, comma, "
                                "semicolon or a character such as '|'",
                                word));
    }
    return word[0];
}

void say_delight(const DelightReport& delight) {
    if (!delight.reason.empty()) spdlog::warn("--delight: {}", delight.reason);
    if (!delight.applied) return;
    spdlog::info(
        "--delight: colours fell with the distance to the power {:.2f} and with the cosine to the "
        "power {:.2f}; stations differ by {:.0f} % where they overlap, {:.0f} % before",
        delight.distance_exponent, delight.incidence_exponent, 100.0 * delight.rms_after,
        100.0 * delight.rms_before);
}

}  // namespace

CLI::Validator finite(double low, double high) {
    const auto check = [low, high](std::string& text) {
        double value = 0.0;
        const bool number = CLI::detail::lexical_cast(text, value);
        // A NaN is in no range.
        return number && value >= low && value <= high
                   ? std::string()
                   : fmt::format("{} is not a number from {} to {}", text, low, high);
    };
    return {check, fmt::format("{} to {}", low, high)};
}

void RegistrationFlags::add_to(CLI::App& command) {
    command.add_option("--poses", poses,
                       "a poses.json to start from, or what to do with poses that are there: "
                       "trust, refine (default) or ignore; give it twice for both");
    command.add_flag("--upright", upright, "scanners are levelled: seek only yaw and position");
}

void RegistrationFlags::apply(RegistrationSettings& settings) const {
    settings.upright = upright;
    for (const std::string& word : poses) {
        if (word == "trust") {
            settings.mode = PriorMode::kTrust;
        } else if (word == "refine") {
            settings.mode = PriorMode::kRefine;
        } else if (word == "ignore") {
            settings.mode = PriorMode::kIgnore;
        } else if (std::filesystem::exists(word)) {
            settings.prior = read_poses(word);
        } else {
            throw Error(
                ExitCode::kUsage,
                fmt::format("--poses {}: no such file, and not trust, refine or ignore", word));
        }
    }
}

void BuildFlags::add_to(CLI::App& command) {
    CLI::Option* by_depth =
        command
            .add_option("--depth", depth,
                        "level of the leaves, the root being 0; chosen from the "
                        "point spacing where neither this nor --voxel-size is given")
            ->check(CLI::Range(1u, kMaxDepth));
    command.add_option("--voxel-size", voxel_size, "edge of a leaf at most this, m")
        ->check(finite(1e-6, 1e6))
        ->excludes(by_depth);
    command.add_option("--lights", lights,
                       "scene.json whose area lights become samples of the tree");
    command
        .add_option(
            "--links", links,
            "rays per lobe to trace now and keep in the file, so that the viewer starts with "
            "bounces at once; 0 leaves them to the viewer")
        ->check(CLI::Range(0u, 1024u))
        ->capture_default_str();
}

std::vector<AreaLight> BuildFlags::area_lights() const {
    return lights.empty() ? std::vector<AreaLight>{} : read_scene(lights).area_lights;
}

BuildSettings BuildFlags::settings(const std::string& command,
                                   const std::vector<std::filesystem::path>& inputs) const {
    return settings(command, describe_inputs(inputs), {});
}

BuildSettings BuildFlags::settings(const std::string& command, std::vector<InputFile> inputs,
                                   const std::string& hash) const {
    if (!lights.empty()) inputs.push_back(describe_input(lights));

    BuildSettings settings;
    settings.depth = depth;
    settings.voxel_size = voxel_size;
    // The header says depth and cube: tiles on a grid fixed elsewhere join to the same bytes.
    settings.provenance = provenance_json("glowworm " + command, inputs, hash);
    return settings;
}

void add_read_flags(CLI::App& command, ReadSettings& settings) {
    command.add_option("--columns", settings.columns,
                       "what the columns of text files mean, such as \"x y z intensity r g b\"; - "
                       "skips one; worked "
                       "out where not given");
    command.add_option_function<std::string>(
        "--delimiter",
        [&settings](const std::string& word) { settings.delimiter = delimiter_named(word); },
        "what parts the columns of text files: space, tab, comma, semicolon or a character; worked "
        "out where not given");
    command.add_flag_callback(
        "--no-crc", [&settings] { settings.check_crc = false; },
        "read E57 pages whose checksum is wrong");
}

void add_surface_flags(CLI::App& command, SurfaceSettings& settings) {
    command.add_option("--neighbours", settings.k, "points a plane is fitted to")
        ->check(CLI::Range(6, 64));
    command
        .add_option("--default-albedo", settings.default_albedo,
                    "linear albedo of points without colour or intensity")
        ->check(finite(0.0, 1.0));
    command.add_flag("--delight", settings.delight,
                     "take the falloff of the scanner's own light out of the colours; fitted "
                     "where stations overlap");
    command.add_option_function<std::string>(
        "--trajectory",
        [&settings](const std::string& file) { settings.trajectory = read_trajectory(file); },
        "where a moving scanner was, lines of \"time x y z\" or \"x y z\": normals face it");
}

nlohmann::ordered_json warnings_json(const std::vector<Warning>& warnings) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Warning& warning : warnings) {
        list.push_back(
            {{"id", warning.id}, {"file", warning.file}, {"sentence", warning.sentence}});
    }
    return list;
}

nlohmann::ordered_json surface_json(const SurfaceReport& report) {
    nlohmann::ordered_json json = {{"points", report.points},
                                   {"surfels", report.surfels},
                                   {"not_finite", report.not_finite},
                                   {"duplicates", report.duplicates},
                                   {"isolated", report.isolated},
                                   {"weak", report.weak},
                                   {"unsure_side", report.unsure_side},
                                   {"facing_inside", report.facing_inside},
                                   {"facing_outside", report.facing_outside},
                                   {"seen_from_trajectory", report.seen_from_trajectory},
                                   {"orientation", describe(report.orientation)},
                                   {"albedo", describe(report.albedo)},
                                   {"range_noise", report.range_noise},
                                   {"median_spacing", report.median_spacing},
                                   {"mean_ndf_length", report.mean_ndf_length}};
    if (report.delight.pairs > 0 || !report.delight.reason.empty()) {
        const DelightReport& delight = report.delight;
        json["delight"] = {{"applied", delight.applied},
                           {"distance_exponent", delight.distance_exponent},
                           {"incidence_exponent", delight.incidence_exponent},
                           {"pairs", delight.pairs},
                           {"rms_before", delight.rms_before},
                           {"rms_after", delight.rms_after}};
    }
    return json;
}

void say_warnings(const std::vector<Warning>& warnings) {
    for (const Warning& warning : warnings) {
        spdlog::warn("{}: {} [{}]", warning.file, warning.sentence, warning.id);
    }
}

void say_surface(const SurfaceReport& report) {
    spdlog::info(
        "{} surfels of {} points; normals turned by {}, {} with a side that nothing decided",
        format_count(report.surfels), format_count(report.points), describe(report.orientation),
        format_count(report.unsure_side));
    if (report.facing_outside > 0) {
        spdlog::info(
            "{} points face outward: what they enclose is too narrow for a scanner to have stood "
            "in",
            format_count(report.facing_outside));
    }
    if (report.weak > 0) {
        spdlog::info("weakly determined normals, expected to be off by more than 11 degrees: {}",
                     format_count(report.weak));
    }
    spdlog::info("albedo from {}; range noise {:.1f} mm; spacing {:.1f} mm; mean NDF length {:.3f}",
                 describe(report.albedo), report.range_noise * 1e3, report.median_spacing * 1e3,
                 report.mean_ndf_length);
    say_delight(report.delight);
}

void say_octree(const OctreeView& octree) {
    spdlog::info("depth {}: {} leaves of {}, {} nodes, {} lobes", octree.grid.depth,
                 format_count(octree.levels.back().node_count),
                 format_length(octree.grid.voxel_size()), format_count(octree.nodes.size()),
                 format_count(octree.lobes.size()));
}

void say_trust(const Registration& registration) {
    std::string table = trust_table(registration);
    while (table.ends_with('\n'))
        table.pop_back();
    spdlog::info("how far each scan is trusted:\n{}", table);
}

}  // namespace glowworm
