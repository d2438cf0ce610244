#pragma once

#include <span>
#include <string>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// The cavers' triple from one point to another, and what goes with it.
struct SurveyLeg {
    double distance = 0.0;         ///< m
    double bearing_deg = 0.0;      ///< clockwise from north (+Y), 0..360; 0 for a vertical leg
    double inclination_deg = 0.0;  ///< above the horizontal, -90..90; 0 where both are one point
    double height = 0.0;           ///< m, positive upward
    double horizontal = 0.0;       ///< m
};

SurveyLeg leg_between(const Vec3d& from, const Vec3d& to);

/// Of the line through the points, m; 0 for fewer than two.
double polyline_length(std::span<const Vec3d> points);

/// Of the closed polygon, m²: half the length of its vector area (Newell), so that of one that is
/// not flat it is the area as seen along its mean normal. 0 for fewer than three points.
double polygon_area(std::span<const Vec3d> points);

enum class MeasureKind { kLeg, kPolyline, kPolygon };

/// Points that were picked one after the other.
struct Measurement {
    MeasureKind kind = MeasureKind::kLeg;
    std::vector<Vec3d> points;  ///< m, world
};

/// One line for people: "3.214 m, bearing 045.0°, inclination +12.3°, height +0.684 m".
std::string measurement_text(const Measurement& measurement);

/// {"measurements":[{"kind","points","length_m" and, by kind, "bearing_deg", "inclination_deg",
/// "height_m", "horizontal_m", "area_m2"}]}
std::string measurements_json(std::span<const Measurement> measurements);

}  // namespace glowworm
