#include "viewer/app/survey_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glowworm {
namespace {

constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kMargin = 1.1;                    // of the box's picture
constexpr double kFinest = 1e-5, kCoarsest = 1e4;  // metres per pixel

Vec3d right_of(const SurveyView& survey) {
    const double bearing = survey.bearing_deg * kRadians;
    return {std::cos(bearing), -std::sin(bearing), 0.0};
}

Vec3d forward_of(const SurveyView& survey) {
    const double bearing = survey.bearing_deg * kRadians, tilt = survey.tilt_deg * kRadians;
    return {std::cos(tilt) * std::sin(bearing), std::cos(tilt) * std::cos(bearing), std::sin(tilt)};
}

Vec3d down_of(const SurveyView& survey) {
    return cross(forward_of(survey), right_of(survey));
}

}  // namespace

SurveyView fitted_survey(const WorldBox& box, double bearing_deg, double tilt_deg, int width,
                         int height) {
    const auto& [low, high] = box;
    SurveyView survey;
    survey.centre = (low + high) / 2.0;
    survey.bearing_deg = bearing_deg;
    survey.tilt_deg = tilt_deg;
    const Vec3d size = high - low, right = right_of(survey), down = down_of(survey);
    const auto reach = [&](const Vec3d& axis) {
        return std::abs(axis.x) * size.x + std::abs(axis.y) * size.y + std::abs(axis.z) * size.z;
    };
    survey.metres_per_pixel = std::clamp(
        kMargin * std::max(reach(right) / std::max(width, 1), reach(down) / std::max(height, 1)),
        kFinest, kCoarsest);
    return survey;
}

View view_of(const SurveyView& survey, int width, int height, double extent) {
    View view;
    view.right = right_of(survey);
    view.forward = forward_of(survey);
    view.down = down_of(survey);
    view.position = survey.centre - view.forward * std::min(survey.section, extent);
    view.orthographic = true;
    view.focal = 1.0 / survey.metres_per_pixel;
    view.width = width;
    view.height = height;
    view.centre_x = width / 2.0;
    view.centre_y = height / 2.0;
    return view;
}

void pan(SurveyView& survey, double right, double down) {
    survey.centre -= (right_of(survey) * right + down_of(survey) * down) * survey.metres_per_pixel;
}

void zoom(SurveyView& survey, double factor, double x, double y) {
    const double before = survey.metres_per_pixel;
    survey.metres_per_pixel = std::clamp(before * factor, kFinest, kCoarsest);
    const double moved = before - survey.metres_per_pixel;
    survey.centre += (right_of(survey) * x + down_of(survey) * y) * moved;
}

void turn(SurveyView& survey, double bearing_deg, double tilt_deg) {
    survey.bearing_deg = std::fmod(survey.bearing_deg + bearing_deg + 720.0, 360.0);
    survey.tilt_deg = std::clamp(survey.tilt_deg + tilt_deg, -90.0, 90.0);
}

double scale_bar_length(double metres_per_pixel, double most_pixels) {
    const double most = metres_per_pixel * most_pixels;
    if (!(most > 0) || !std::isfinite(most)) return 0.0;
    const double power = std::pow(10.0, std::floor(std::log10(most)));
    for (const double step : {5.0, 2.0}) {
        if (step * power <= most) return step * power;
    }
    return power;
}

ScreenDirection north_on_screen(const View& view) {
    return {view.right.y, view.down.y};
}

}  // namespace glowworm
