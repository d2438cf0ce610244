#include "preprocess/pipeline.h"

#include <fmt/format.h>

#include "octree/area_lights.h"
#include "octree/error.h"
#include "preprocess/station.h"

namespace glowworm {
namespace {

/// Throws unless every scan was placed and is held, or the user goes on without those that were
/// not placed.
void require_trust(const Registration& registration, bool allow_missing_scans) {
    if (registration.trustworthy()) return;
    const bool any_left = registration.unregistered < registration.poses.scans.size();
    if (registration.loose.empty() && allow_missing_scans && any_left) return;
    throw Error(ExitCode::kNotTrustworthy,
                fmt::format("{}; {}", distrust(registration),
                            !registration.loose.empty()
                                ? "register the scans, look at their poses and go on with "
                                  "--poses FILE --poses trust"
                            : any_left ? "--allow-missing-scans goes on without them"
                                       : "check that the scans overlap, or give --poses"));
}

}  // namespace

std::vector<Scan> read_clean_scans(std::span<const std::filesystem::path> files,
                                   const ConvertSettings& settings, const Phases& begin,
                                   Conversion& conversion) {
    std::vector<Scan> scans;
    std::vector<ReadReport> reports(files.size());
    const Progress reading = begin("read", "files");
    for (std::size_t i = 0; i < files.size(); ++i) {
        reading(i, files.size());
        for (Scan& scan : read_scans(files[i], settings.read, &reports[i])) {
            scans.push_back(std::move(scan));
        }
    }
    conversion.scans = scans.size();
    conversion.warnings = preflight(scans, reports);

    const Progress cleaning = begin("clean", "scans");
    for (std::size_t i = 0; i < scans.size(); ++i) {
        cleaning(i, scans.size());
        CleanReport report;
        scans[i].has_viewpoint = scans[i].has_viewpoint || origin_is_viewpoint(scans[i].points);
        scans[i].points = clean(scans[i].points, scans[i].has_viewpoint, settings.clean, &report);
        conversion.points += report.points_in;
        conversion.outliers += report.outliers;
    }
    return scans;
}

Conversion convert_scans(std::span<const std::filesystem::path> files,
                         const ConvertSettings& settings, const Phases& begin,
                         const std::function<void(const Registration&)>& report) {
    Conversion done;
    std::vector<Scan> scans = read_clean_scans(files, settings, begin, done);

    done.registration = align_scans(scans, settings.registration, begin("register", "pairs"));
    report(done.registration);
    require_trust(done.registration, settings.allow_missing_scans);

    PointCloud cloud = merge_scans(scans, done.registration.poses, settings.merge,
                                   begin("merge", "points"), &done.merge);
    scans = {};

    SurfelCloud surfels =
        make_surfels(cloud, settings.surface, &done.surface, begin("surface", "points"));
    cloud = {};

    add_area_lights(surfels, settings.area_lights);
    done.octree = build_octree(surfels, settings.build, begin("build", "surfels"));
    return done;
}

}  // namespace glowworm
