#include "viewer/app/navigator.h"

#include <cmath>

#include "viewer/app/walk.h"

namespace glowworm {
namespace {

constexpr double kRadiansPerPixel = 0.004;  // of mouse movement
constexpr double kDegreesPerPixel = 0.25;   // the same for a survey
constexpr double kZoomPerPixel = 1.005, kZoomPerNotch = 1.2;
constexpr double kDegreesPerSecond = 30.0;  // of a survey that rotates
constexpr double kAssumedDistance = 3.0;    // m, where nothing is under the cursor

WorldBox bounds_of(const OctreeView& octree) {
    return {octree.grid.origin + vec3_cast<double>(octree.bounds_min),
            octree.grid.origin + vec3_cast<double>(octree.bounds_max)};
}

}  // namespace

Navigator::Navigator(const OctreeView& octree, const Camera& start, ControlScheme scheme)
    : octree_(octree),
      start_(start),
      scheme_(scheme),
      mode_(first_mode(scheme)),
      camera_(start),
      survey_(fitted_survey(bounds_of(octree), 0.0, -90.0, start.width, start.height)),
      screen_height_(start.height) {}

WorldBox Navigator::bounds() const {
    return bounds_of(octree_);
}

View Navigator::view(int width, int height) const {
    if (!in_survey()) return view_of(camera_.camera(width, height));
    const auto [low, high] = bounds();
    const double extent = length(high - low) + length(survey_.centre - (low + high) / 2.0) + 1.0;
    SurveyView scaled = survey_;
    scaled.metres_per_pixel *= static_cast<double>(screen_height_) / height;
    return view_of(scaled, width, height, extent);
}

void Navigator::set_scheme(ControlScheme scheme) {
    scheme_ = scheme;
    mode_ = first_mode(scheme);
}

void Navigator::show_survey(double tilt_deg, int width, int height) {
    const double bearing = in_survey() ? survey_.bearing_deg : 0.0, section = survey_.section;
    survey_ = fitted_survey(bounds(), bearing, tilt_deg, width, height);
    survey_.section = section;
    mode_ = MoveMode::kSurvey;
}

void Navigator::face(double bearing_deg) {
    if (in_survey()) {
        survey_.bearing_deg = bearing_deg;
    } else {
        camera_.face(bearing_deg);
    }
}

void Navigator::reset(int width, int height) {
    rotating_ = false;
    if (in_survey()) {
        survey_ = fitted_survey(bounds(), 0.0, -90.0, width, height);
    } else {
        camera_.take_place_of(start_);
    }
}

void Navigator::go_to(const Camera& camera) {
    camera_.take_place_of(camera);
    if (in_survey()) mode_ = MoveMode::kFly;
}

bool Navigator::step(const FlyInput& held, double seconds) {
    if (rotating()) {
        turn(survey_, kDegreesPerSecond * seconds, 0.0);
        return true;
    }
    if (in_survey()) return false;
    bool moved = held.ahead != 0 || held.aside != 0 || held.rise != 0;
    camera_.move(held, seconds);
    if (mode_ == MoveMode::kWalk) {
        const Vec3d at = camera_.position();
        if (const auto wanted = walking_height(octree_, at)) {
            const double z = stepped_height(at.z, *wanted, seconds);
            moved = moved || std::abs(z - at.z) > 1e-3;
            camera_.move_to({at.x, at.y, z});
        }
    }
    return moved;
}

void Navigator::drag(DragAction action, double right, double down,
                     const std::optional<Vec3d>& point, const View& view) {
    if (in_survey()) {
        if (action == DragAction::kPan) pan(survey_, right, down);
        if (action == DragAction::kTilt) {
            turn(survey_, -right * kDegreesPerPixel, -down * kDegreesPerPixel);
        }
        if (action == DragAction::kTurnZoom) {
            turn(survey_, -right * kDegreesPerPixel, 0.0);
            zoom(survey_, std::pow(kZoomPerPixel, down), 0.0, 0.0);
        }
        return;
    }
    const Vec3d pivot = point.value_or(camera_.position() + camera_.forward() * kAssumedDistance);
    switch (action) {
        case DragAction::kNone:
            break;
        case DragAction::kLook:
            camera_.turn(right * kRadiansPerPixel, -down * kRadiansPerPixel);
            break;
        case DragAction::kOrbit:
        case DragAction::kTilt:
            camera_.orbit(pivot, right * kRadiansPerPixel, -down * kRadiansPerPixel);
            break;
        case DragAction::kTurnZoom:
            camera_.orbit(pivot, right * kRadiansPerPixel, 0.0);
            camera_.dolly(pivot, std::pow(kZoomPerPixel, down));
            break;
        case DragAction::kPan: {
            const double metres = std::max(project(view, pivot).depth, 0.1) / view.focal;
            camera_.pan(-right * metres, down * metres);
            break;
        }
    }
}

bool Navigator::wheel(double notches, double x, double y, const std::optional<Vec3d>& point,
                      const View& view) {
    if (wheel_action(scheme_, mode_) == WheelAction::kSpeed) {
        camera_.change_speed(notches);
        return false;
    }
    const double factor = std::pow(kZoomPerNotch, -notches);
    if (in_survey()) {
        zoom(survey_, factor, x - view.centre_x, y - view.centre_y);
    } else {
        camera_.dolly(point.value_or(camera_.position() + camera_.forward() * kAssumedDistance),
                      factor);
    }
    return true;
}

}  // namespace glowworm
