#include "viewer/app/fly_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glowworm {
namespace {

constexpr double kSteepest = 89.0 * std::numbers::pi / 180.0;
constexpr double kSlowest = 0.01, kFastest = 200.0;  // m/s

}  // namespace

FlyCamera::FlyCamera(const Camera& camera) {
    take_place_of(camera);
}

void FlyCamera::take_place_of(const Camera& camera) {
    position_ = camera.position;
    vfov_deg_ = camera.vfov_deg;
    const Vec3d d = normalized(camera.look_at - camera.position, Vec3d{1, 0, 0});
    azimuth_ = std::atan2(d.y, d.x);
    elevation_ = std::clamp(std::asin(std::clamp(d.z, -1.0, 1.0)), -kSteepest, kSteepest);
}

void FlyCamera::move(const FlyInput& input, double seconds) {
    position_ += (forward() * input.ahead + right() * input.aside + Vec3d{0, 0, input.rise}) *
                 (speed_ * seconds);
}

void FlyCamera::turn(double right, double up) {
    azimuth_ = std::remainder(azimuth_ - right, 2.0 * std::numbers::pi);
    elevation_ = std::clamp(elevation_ + up, -kSteepest, kSteepest);
}

void FlyCamera::change_speed(double notches) {
    speed_ = std::clamp(speed_ * std::pow(1.25, notches), kSlowest, kFastest);
}

void FlyCamera::orbit(const Vec3d& pivot, double right_angle, double up_angle) {
    const Vec3d offset = pivot - position_, side = right(), ahead = forward();
    const Vec3d above = cross(side, ahead);
    const double x = dot(offset, side), y = dot(offset, above), z = dot(offset, ahead);
    turn(right_angle, up_angle);
    position_ = pivot - (right() * x + cross(right(), forward()) * y + forward() * z);
}

void FlyCamera::pan(double to_right, double to_up) {
    position_ += right() * to_right + cross(right(), forward()) * to_up;
}

void FlyCamera::dolly(const Vec3d& point, double factor) {
    position_ = point + (position_ - point) * factor;
}

void FlyCamera::face(double bearing_deg) {
    azimuth_ = std::numbers::pi / 2.0 - bearing_deg * std::numbers::pi / 180.0;
    elevation_ = 0.0;
}

void FlyCamera::set_vfov_deg(double vfov_deg) {
    vfov_deg_ = std::clamp(vfov_deg, 10.0, 120.0);
}

Vec3d FlyCamera::right() const {
    return {std::sin(azimuth_), -std::cos(azimuth_), 0.0};
}

double FlyCamera::bearing_deg() const {
    const double bearing = 90.0 - azimuth_ * 180.0 / std::numbers::pi;
    return std::fmod(bearing + 720.0, 360.0);
}

Vec3d FlyCamera::forward() const {
    return {std::cos(elevation_) * std::cos(azimuth_), std::cos(elevation_) * std::sin(azimuth_),
            std::sin(elevation_)};
}

Camera FlyCamera::camera(int width, int height) const {
    Camera camera;
    camera.name = "fly";
    camera.position = position_;
    camera.look_at = position_ + forward();
    camera.vfov_deg = vfov_deg_;
    camera.width = width;
    camera.height = height;
    return camera;
}

}  // namespace glowworm
