#include "viewer/app/default_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "octree/pack.h"

namespace glowworm {
namespace {

constexpr std::size_t kSurveyPoints = 60000;        // enough to tell a wall from an opening
constexpr int kAzimuths = 36;                       // of 10° each
constexpr int kElevations = 5;                      // patches one above the other, of 8° each
constexpr double kLowest = -0.35, kHighest = 0.35;  // rad: the band of elevations a walker looks in
constexpr double kHeadlampHeight = 0.15;            // m over the eye
constexpr float kLampIntensity = 4.0f;              // W·sr⁻¹: 1 W·m⁻² at 2 m

/// An even subsample of the cloud, in the octree's frame.
struct Survey {
    std::vector<Vec3d> points, normals;
};

Survey survey_of(const OctreeView& octree) {
    Survey survey;
    const double share = std::min(1.0, static_cast<double>(kSurveyPoints) /
                                           std::max<double>(1.0, double(octree.surfels.size())));
    for (const Chunk& chunk : octree.chunks) {
        const auto count = static_cast<std::uint32_t>(std::ceil(share * chunk.count));
        for (const PackedSurfel& surfel : octree.surfels.subspan(chunk.first, count)) {
            const double cell = chunk.box_edge / 65536.0;
            const std::uint32_t q[3] = {surfel.position_xy & 0xffff, surfel.position_xy >> 16,
                                        surfel.position_z_radius & 0xffff};
            Vec3d point;
            for (int axis = 0; axis < 3; ++axis) {
                point[axis] = chunk.box_min[axis] + (q[axis] + 0.5) * cell;
            }
            survey.points.push_back(point);
            survey.normals.push_back(vec3_cast<double>(unpack_octahedral(surfel.normal)));
        }
    }
    return survey;
}

/// How far one sees from a place in each direction of a walker's horizon, m: of the nearest points
/// in each patch of the view, the median over a direction's patches. Walls farther on, which the
/// nearest hide, do not count. 0 where a direction has no walls: a hole in the scan.
std::array<double, kAzimuths> free_distances(const Survey& survey, const Vec3d& eye) {
    constexpr double kNothing = std::numeric_limits<double>::infinity();
    std::array<std::array<double, kElevations>, kAzimuths> nearest;
    for (auto& patches : nearest)
        patches.fill(kNothing);
    for (const Vec3d& point : survey.points) {
        const Vec3d d = point - eye;
        const double range = length(d);
        if (range < 0.05) continue;
        const double elevation = std::asin(std::clamp(d.z / range, -1.0, 1.0));
        const double height = (elevation - kLowest) / (kHighest - kLowest) * kElevations;
        if (height < 0.0 || height >= kElevations) continue;
        const double turn = (std::atan2(d.y, d.x) / (2.0 * std::numbers::pi) + 1.0) * kAzimuths;
        double& patch =
            nearest[static_cast<std::size_t>(turn) % kAzimuths][static_cast<std::size_t>(height)];
        patch = std::min(patch, range);
    }
    std::array<double, kAzimuths> free{};
    for (std::size_t i = 0; i < kAzimuths; ++i) {
        auto& patches = nearest[i];
        std::sort(patches.begin(), patches.end());
        const auto seen = std::count_if(patches.begin(), patches.end(),
                                        [](double range) { return range < kNothing; });
        if (seen > 0) free[i] = patches[static_cast<std::size_t>(seen / 2)];
    }
    return free;
}

struct Lookout {
    Vec3d eye;       ///< m, octree's frame
    double azimuth;  ///< rad
    double reach;    ///< m of free sight that way
};

Lookout lookout_from(const Survey& survey, const Vec3d& eye) {
    const auto free = free_distances(survey, eye);
    Lookout best{eye, 0.0, -1.0};
    for (std::size_t i = 0; i < free.size(); ++i) {
        // A direction counts with its neighbours: the middle of a passage, not its edge.
        const double reach = std::min({free[(i + kAzimuths - 1) % kAzimuths] * 1.5, free[i],
                                       free[(i + 1) % kAzimuths] * 1.5});
        if (reach <= best.reach) continue;
        const double azimuth = (static_cast<double>(i) + 0.5) * 2.0 * std::numbers::pi / kAzimuths;
        best = {eye, azimuth, reach};
    }
    return best;
}

/// How much of the view round a place is walls close by (within three times the nearest), 0..1: in
/// a passage most of it, in the rock between two passages little.
double enclosure_at(const Survey& survey, const Vec3d& place) {
    constexpr int kColumns = 24, kRows = 12;  // patches of equal solid angle
    double nearest = std::numeric_limits<double>::infinity();
    for (const Vec3d& point : survey.points)
        nearest = std::min(nearest, length(point - place));
    std::array<bool, kColumns * kRows> walled{};
    for (const Vec3d& point : survey.points) {
        const Vec3d d = point - place;
        const double range = length(d);
        if (range > 3.0 * nearest || range <= 0.0) continue;
        const double turn = (std::atan2(d.y, d.x) / (2.0 * std::numbers::pi) + 1.0) * kColumns;
        const double height = std::min((d.z / range + 1.0) / 2.0 * kRows, kRows - 0.5);
        walled[static_cast<std::size_t>(turn) % kColumns +
               static_cast<std::size_t>(height) * kColumns] = true;
    }
    return static_cast<double>(std::count(walled.begin(), walled.end(), true)) / walled.size();
}

/// From a wall straight to the one opposite, m; infinite where there is none.
double distance_across(const Survey& survey, const Vec3d& wall, const Vec3d& direction) {
    double across = std::numeric_limits<double>::infinity();
    for (const Vec3d& point : survey.points) {
        const double ahead = dot(point - wall, direction);
        const double beside = length(point - wall - direction * ahead);
        if (ahead > 0.3 && beside < 0.15 * ahead) across = std::min(across, ahead);
    }
    return across;
}

/// Places inside the cave for clouds whose stations are unknown: halfway from a wall to the one
/// opposite, on either side as the normals of such clouds may be turned. The most enclosed few.
std::vector<Vec3d> places_between_walls(const Survey& survey) {
    constexpr std::size_t kTried = 16, kKept = 4;
    std::vector<std::pair<double, Vec3d>> places;
    const std::size_t step = std::max<std::size_t>(1, survey.points.size() / kTried);
    for (std::size_t i = step / 2; i < survey.points.size(); i += step) {
        for (const double side : {1.0, -1.0}) {
            const Vec3d direction = survey.normals[i] * side;
            const double across = distance_across(survey, survey.points[i], direction);
            if (!std::isfinite(across)) continue;
            const Vec3d place = survey.points[i] + direction * (across / 2.0);
            places.emplace_back(enclosure_at(survey, place), place);
        }
    }
    std::stable_sort(places.begin(), places.end(),
                     [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Vec3d> kept;
    for (std::size_t i = 0; i < std::min(kKept, places.size()); ++i) {
        kept.push_back(places[i].second);
    }
    return kept;
}

/// Where to stand: at a station that saw the cave from itself, else between two walls.
std::vector<Vec3d> standing_places(const OctreeView& octree, const Survey& survey) {
    std::vector<Vec3d> places;
    for (const StationRecord& station : octree.stations) {
        if (station.has_viewpoint == 0) continue;
        places.push_back(Vec3d{station.position[0], station.position[1], station.position[2]} -
                         octree.grid.origin);
    }
    if (places.empty()) places = places_between_walls(survey);
    if (places.empty()) {
        places.push_back(vec3_cast<double>(octree.bounds_min + octree.bounds_max) / 2.0);
    }
    return places;
}

}  // namespace

std::vector<AreaLight> area_lights_of(const OctreeView& octree) {
    std::vector<AreaLight> lights;
    for (const AreaLightRecord& record : octree.area_lights) {
        AreaLight light;
        light.name = octree.names.substr(record.name_offset, record.name_bytes);
        for (std::size_t i = 0; i < 4; ++i) {
            light.corners[i] = {record.corners[3 * i], record.corners[3 * i + 1],
                                record.corners[3 * i + 2]};
        }
        light.radiance = {record.radiance[0], record.radiance[1], record.radiance[2]};
        lights.push_back(light);
    }
    return lights;
}

PointLight headlamp_at(const Camera& camera, float radiant_intensity) {
    const Vec3d above = camera.position + camera.up * kHeadlampHeight;
    return {kHeadlampName, above, Vec3f{1, 1, 1} * radiant_intensity};
}

std::optional<Headlamp> take_headlamp(Scene& scene) {
    const auto found = std::find_if(scene.point_lights.begin(), scene.point_lights.end(),
                                    [](const PointLight& l) { return l.name == kHeadlampName; });
    if (found == scene.point_lights.end()) return std::nullopt;
    const Headlamp headlamp{found->position - Vec3d{0, 0, kHeadlampHeight},
                            found->radiant_intensity.y};
    scene.point_lights.erase(found);
    return headlamp;
}

Scene default_scene(const OctreeView& octree) {
    const Survey survey = survey_of(octree);
    const std::vector<Vec3d> places = standing_places(octree, survey);
    Lookout best = lookout_from(survey, places.front());
    for (const Vec3d& place : places) {
        const Lookout candidate = lookout_from(survey, place);
        // The first station is where the survey began: another must be clearly better.
        if (candidate.reach > 1.5 * best.reach) best = candidate;
    }

    Scene scene;
    scene.area_lights = area_lights_of(octree);
    for (std::size_t i = 0; i < places.size(); ++i) {
        scene.point_lights.push_back({"station " + std::to_string(i + 1),
                                      octree.grid.origin + places[i] + Vec3d{0, 0, 0.2},
                                      Vec3f{1.0f, 0.85f, 0.65f} * kLampIntensity});
    }
    Camera camera;
    camera.name = "start";
    camera.position = octree.grid.origin + best.eye;
    camera.look_at = camera.position + Vec3d{std::cos(best.azimuth), std::sin(best.azimuth), -0.08};
    camera.vfov_deg = 65.0;
    scene.cameras.push_back(camera);
    scene.point_lights.push_back(headlamp_at(camera, 0.25f * kLampIntensity));
    return scene;
}

}  // namespace glowworm
