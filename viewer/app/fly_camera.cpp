#include "viewer/app/fly_camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glowworm {
namespace {

constexpr double kSteepest = 89.0 * std::numbers::pi / 180.0;
constexpr double kSlowest = 0.01, kFastest = 200.0;  // m/s

}  // namespace

FlyCamera::FlyCamera(const Camera& camera)
    : position_(camera.position), vfov_deg_(camera.vfov_deg) {
    const Vec3d d = normalized(camera.look_at - camera.position, Vec3d{1, 0, 0});
    azimuth_ = std::atan2(d.y, d.x);
    elevation_ = std::clamp(std::asin(std::clamp(d.z, -1.0, 1.0)), -kSteepest, kSteepest);
}

void FlyCamera::move(const FlyInput& input, double seconds) {
    const Vec3d ahead = forward();
    const Vec3d aside{std::sin(azimuth_), -std::cos(azimuth_), 0.0};
    position_ +=
        (ahead * input.ahead + aside * input.aside + Vec3d{0, 0, input.rise}) * (speed_ * seconds);
}

void FlyCamera::turn(double right, double up) {
    azimuth_ = std::remainder(azimuth_ - right, 2.0 * std::numbers::pi);
    elevation_ = std::clamp(elevation_ + up, -kSteepest, kSteepest);
}

void FlyCamera::change_speed(double notches) {
    speed_ = std::clamp(speed_ * std::pow(1.25, notches), kSlowest, kFastest);
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
