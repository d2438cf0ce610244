#include "viewer/app/measure.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

namespace glowworm {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

std::vector<Vec3d> closed(std::span<const Vec3d> points) {
    std::vector<Vec3d> ring(points.begin(), points.end());
    if (!ring.empty()) ring.push_back(ring.front());
    return ring;
}

}  // namespace

SurveyLeg leg_between(const Vec3d& from, const Vec3d& to) {
    const Vec3d d = to - from;
    SurveyLeg leg;
    leg.distance = length(d);
    leg.horizontal = std::hypot(d.x, d.y);
    leg.height = d.z;
    if (leg.horizontal > 0) {
        leg.bearing_deg = std::fmod(std::atan2(d.x, d.y) * kDegrees + 360.0, 360.0);
    }
    leg.inclination_deg = std::atan2(d.z, leg.horizontal) * kDegrees;
    return leg;
}

double polyline_length(std::span<const Vec3d> points) {
    double sum = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
        sum += length(points[i] - points[i - 1]);
    return sum;
}

double polygon_area(std::span<const Vec3d> points) {
    Vec3d sum;
    for (std::size_t i = 2; i < points.size(); ++i) {
        sum += cross(points[i - 1] - points[0], points[i] - points[0]);
    }
    return length(sum) / 2.0;
}

std::string measurement_text(const Measurement& measurement) {
    const std::vector<Vec3d>& points = measurement.points;
    if (points.size() < 2) return "one point";
    switch (measurement.kind) {
        case MeasureKind::kLeg: {
            const SurveyLeg leg = leg_between(points[0], points[1]);
            return fmt::format(
                "{:.3f} m, bearing {:05.1f}°, inclination {:+.1f}°, height {:+.3f} m, horizontal "
                "{:.3f} m",
                leg.distance, leg.bearing_deg, leg.inclination_deg, leg.height, leg.horizontal);
        }
        case MeasureKind::kPolyline:
            return fmt::format("{:.3f} m along {} points", polyline_length(points), points.size());
        case MeasureKind::kPolygon:
            return fmt::format("{:.3f} m², {:.3f} m around", polygon_area(points),
                               polyline_length(closed(points)));
    }
    return {};
}

std::string measurements_json(std::span<const Measurement> measurements) {
    using Json = nlohmann::ordered_json;
    constexpr const char* kKinds[] = {"leg", "polyline", "polygon"};
    Json list = Json::array();
    for (const Measurement& m : measurements) {
        Json points = Json::array();
        for (const Vec3d& p : m.points)
            points.push_back({p.x, p.y, p.z});
        Json json{{"kind", kKinds[static_cast<int>(m.kind)]}, {"points", points}};
        if (m.kind == MeasureKind::kPolygon) {
            json["length_m"] = polyline_length(closed(m.points));
            json["area_m2"] = polygon_area(m.points);
        } else {
            json["length_m"] = polyline_length(m.points);
        }
        if (m.kind == MeasureKind::kLeg && m.points.size() >= 2) {
            const SurveyLeg leg = leg_between(m.points[0], m.points[1]);
            json["bearing_deg"] = leg.bearing_deg;
            json["inclination_deg"] = leg.inclination_deg;
            json["height_m"] = leg.height;
            json["horizontal_m"] = leg.horizontal;
        }
        list.push_back(json);
    }
    return Json{{"measurements", list}}.dump(1) + "\n";
}

}  // namespace glowworm
