#include "preprocess/read/preflight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "preprocess/read/append_block.h"

namespace glowworm {
namespace {

constexpr double kNoticed = 0.01;  // share of the points from which on a warning is worth it

/// Warnings of one scan, each added with its id.
class Warner {
  public:
    Warner(const ScanFacts& scan, std::vector<Warning>& warnings)
        : scan_(scan), warnings_(warnings) {}
    void add(const char* id, std::string sentence) {
        warnings_.push_back({id, scan_.counts.name, std::move(sentence)});
    }

  private:
    const ScanFacts& scan_;
    std::vector<Warning>& warnings_;
};

double largest_coordinate(const ScanFacts& scan) {
    double largest = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        largest = std::max({largest, std::abs(scan.low[axis]), std::abs(scan.high[axis])});
    }
    return largest;
}

double extent(const ScanFacts& scan) {
    const Vec3d size = scan.high - scan.low;
    return std::max({size.x, size.y, size.z});
}

/// The distance between neighbouring 32-bit floats at `value`.
double float_step(double value) {
    return std::ldexp(1.0, std::max(-126, std::ilogb(std::max(value, 1e-30))) - 23);
}

void warn_of_colours(const ScanFacts& scan, Warner& warn) {
    const ScanCounts& counts = scan.counts;
    if (counts.no_colour > 0) {
        warn.add("colour-invalid",
                 fmt::format("the file marks {} of its {} points as without colour; they got the "
                             "mean colour of the points around them",
                             counts.no_colour, counts.found()));
    }
    if (counts.no_intensity > 0) {
        warn.add("intensity-invalid",
                 fmt::format("the file marks {} of its {} points as without intensity; they got "
                             "the mean intensity of the points around them",
                             counts.no_intensity, counts.found()));
    }
    if (!scan.has_colours || !(scan.darkest == scan.brightest)) return;
    if (scan.brightest == Rgb8{}) {
        warn.add("colour-black",
                 "every colour is black, as where a scan was exported with colour but never "
                 "photographed; export it without colour, or albedo will be zero");
    } else {
        warn.add("colour-constant",
                 "every point has the same colour; the scan was perhaps not coloured");
    }
}

void warn_of_points(const ScanFacts& scan, Warner& warn) {
    const ScanCounts& counts = scan.counts;
    const std::uint64_t found = counts.found();
    const double all = static_cast<double>(std::max<std::uint64_t>(found, 1));
    if (static_cast<double>(counts.no_return) > kNoticed * all) {
        warn.add("points-at-origin", fmt::format("{} of its {} points were exactly at (0,0,0), the "
                                                 "scanner's sign for no return, and "
                                                 "were dropped",
                                                 counts.no_return, found));
    }
    if (counts.not_finite > 0) {
        warn.add("points-not-finite",
                 fmt::format("{} of its {} points have a coordinate that is not a finite "
                             "number and were dropped",
                             counts.not_finite, found));
    }
    if (counts.too_far > 0) {
        warn.add("points-too-far",
                 fmt::format("{} of its {} points have a coordinate beyond {:.0g} m, which is how "
                             "programs write \"no value\", and were dropped",
                             counts.too_far, found, kFarthestMetres));
    }
    if (counts.declared != 0 && counts.declared != found) {
        warn.add("points-missing",
                 fmt::format("it announces {} points but holds {}; copy or export it again",
                             counts.declared, found));
    }
    if (scan.duplicate_share > kNoticed) {
        warn.add("points-duplicate",
                 fmt::format("{:.0f} % of its points lie exactly where another one does; "
                             "it was perhaps merged with itself",
                             100.0 * scan.duplicate_share));
    }
}

/// Whether one of the words of `crs` is a foot: "US survey foot", "Foot_US", "ft", "ftUS".
bool mentions_feet(std::string_view crs) {
    constexpr std::string_view kWords[] = {"foot", "feet", "ft", "ftus", "usft", "footus"};
    std::string word;
    for (std::size_t i = 0; i <= crs.size(); ++i) {
        const int c = i < crs.size() ? static_cast<unsigned char>(crs[i]) : ' ';
        if (std::isalpha(c)) {
            word += static_cast<char>(std::tolower(c));
        } else {
            if (std::ranges::find(kWords, word) != std::end(kWords)) return true;
            word.clear();
        }
    }
    return false;
}

struct CrsParts {
    std::string_view horizontal, vertical;
};

/// WKT, or what las_crs says, in the part for x and y and the part for heights, which follows it.
/// The name of a compound system, which may say the units of both, is in neither.
CrsParts parts_of(std::string_view crs) {
    constexpr std::string_view kVertical[] = {"VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS",
                                              "vertical unit"};
    const bool compound = crs.starts_with("COMPD_CS") || crs.starts_with("COMPOUNDCRS");
    const std::size_t inner = compound ? crs.find('[', crs.find('[') + 1) : 0;
    if (inner != std::string_view::npos) crs.remove_prefix(inner);
    std::size_t split = crs.size();
    for (const std::string_view name : kVertical)
        split = std::min(split, crs.find(name));
    return {crs.substr(0, split), crs.substr(split)};
}

/// Longitude and latitude with heights in metres: far higher than wide, in degrees' range.
bool looks_like_degrees(const ScanFacts& scan) {
    const Vec3d size = scan.high - scan.low;
    const double wide = std::max(size.x, size.y);
    const bool in_range = std::abs(scan.low.x) <= 180.0 && std::abs(scan.high.x) <= 180.0 &&
                          std::abs(scan.low.y) <= 90.0 && std::abs(scan.high.y) <= 90.0;
    const bool away_from_zero =
        std::min(std::abs(scan.low.x), std::abs(scan.high.x)) > 10.0 * wide &&
        std::min(std::abs(scan.low.y), std::abs(scan.high.y)) > 10.0 * wide;
    return in_range && away_from_zero && wide > 0.0 && wide < 0.1 && size.z > 20.0 * wide;
}

void warn_of_units(const ScanFacts& scan, Warner& warn) {
    const bool geographic = scan.crs.starts_with("GEOGCS") || scan.crs.starts_with("GEOGCRS");
    if (geographic || looks_like_degrees(scan)) {
        warn.add("units-degrees",
                 "its coordinates are degrees of longitude and latitude, not metres; export it "
                 "in a projected coordinate system");
    } else if (mentions_feet(parts_of(scan.crs).horizontal)) {
        warn.add("units-feet",
                 "its coordinate system is in feet but Glowworm takes metres; export it in metres");
    } else if (mentions_feet(parts_of(scan.crs).vertical)) {
        warn.add("units-feet",
                 "its heights are in feet while its x and y are not, so the cave would be 3.3 "
                 "times too high; export all three in metres");
    } else if (extent(scan) > 5000.0) {
        warn.add("units-too-large",
                 fmt::format("it is {:.0f} m across; if that should be millimetres or feet, "
                             "export it in metres",
                             extent(scan)));
    } else if (extent(scan) > 0.0 && extent(scan) < 0.05) {
        warn.add("units-too-small",
                 fmt::format("it is {:.1f} mm across; if that should be more, export it in metres",
                             1e3 * extent(scan)));
    }
}

void warn_of_floats(const ScanFacts& scan, Warner& warn) {
    const double step = float_step(largest_coordinate(scan));
    if (scan.on_float_grid && step >= 1e-3 && scan.counts.kept >= 16) {
        warn.add("float-lost",
                 fmt::format("its coordinates reach {:.0f} m but were stored as 32-bit floats, so "
                             "points lie on a grid of {:.1f} mm; export it in double or with a "
                             "local origin",
                             largest_coordinate(scan), 1e3 * step));
    }
    if (float_step(extent(scan)) >= 1e-3) {
        warn.add("float-range",
                 fmt::format("it is {:.0f} m across, where 32-bit floats step by {:.1f} mm; split "
                             "it into parts",
                             extent(scan), 1e3 * float_step(extent(scan))));
    }
}

}  // namespace

std::vector<Warning> preflight(std::span<const ScanFacts> scans) {
    std::vector<Warning> warnings;
    const bool some_posed = std::ranges::any_of(scans, &ScanFacts::has_pose);
    double finest = 0.0;
    std::string finest_name;
    for (const ScanFacts& scan : scans) {
        if (scan.spacing <= 0.0 || (finest > 0.0 && scan.spacing >= finest)) continue;
        finest = scan.spacing;
        finest_name = scan.counts.name;
    }
    for (const ScanFacts& scan : scans) {
        Warner warn(scan, warnings);
        warn_of_colours(scan, warn);
        warn_of_points(scan, warn);
        warn_of_units(scan, warn);
        warn_of_floats(scan, warn);
        if (some_posed && !scan.has_pose) {
            warn.add(
                "pose-missing",
                "it has no pose while other scans have one; it will be registered from nothing");
        }
        if (finest > 0.0 && scan.spacing > 10.0 * finest) {
            warn.add("spacing-apart",
                     fmt::format("its points are {:.2g} m apart, those of {} {:.2g} m; the units "
                                 "of one may be wrong",
                                 scan.spacing, finest_name, finest));
        }
    }
    return warnings;
}

std::vector<Warning> preflight(std::span<const Scan> scans, std::span<const ReadReport> reports) {
    std::vector<ScanFacts> facts;
    for (const Scan& scan : scans) {
        ScanCounts counts{.name = scan.name, .kept = scan.points.size()};
        for (const ReadReport& report : reports) {
            const auto found = std::ranges::find(report.scans, scan.name, &ScanCounts::name);
            if (found != report.scans.end()) counts = *found;
        }
        facts.push_back(facts_of(scan, counts));
    }
    return preflight(facts);
}

}  // namespace glowworm
