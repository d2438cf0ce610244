#pragma once

#include "octree/scene.h"

namespace glowworm {

/// What moves a fly camera in one step: each from -1 to 1.
struct FlyInput {
    double ahead = 0.0;  ///< along the line of sight
    double aside = 0.0;  ///< to the right
    double rise = 0.0;   ///< along the world's up
};

/// A camera that is flown: it looks where the mouse turns it, its roll is locked, and its speed
/// stays what the wheel last made it.
class FlyCamera {
  public:
    FlyCamera() = default;
    /// Starts where `camera` stands, looking where it looks.
    explicit FlyCamera(const Camera& camera);

    void move(const FlyInput& input, double seconds);
    /// Turns by angles in radians: to the right and up. The line of sight stops short of vertical.
    void turn(double right, double up);
    /// One notch of the wheel is a factor of 1.25.
    void change_speed(double notches);

    /// Turns by such angles round `pivot`, which stays where it is in the picture.
    void orbit(const Vec3d& pivot, double right, double up);
    /// Moves by m along the picture's edges.
    void pan(double right, double up);
    /// The distance to `point` becomes `factor` times as large; it stays where it is in the
    /// picture.
    void dolly(const Vec3d& point, double factor);
    /// Looks level toward a bearing, degrees clockwise from north (+Y).
    void face(double bearing_deg);
    void move_to(const Vec3d& position) { position_ = position; }
    /// Stands where `camera` stands and looks where it looks; the speed stays.
    void take_place_of(const Camera& camera);
    void set_vfov_deg(double vfov_deg);  ///< clamped to 10..120

    double speed() const { return speed_; }  ///< m/s
    double vfov_deg() const { return vfov_deg_; }
    const Vec3d& position() const { return position_; }
    Vec3d forward() const;
    Vec3d right() const;
    double bearing_deg() const;  ///< 0..360
    /// The camera at this moment, for a picture of `width` x `height` pixels.
    Camera camera(int width, int height) const;

  private:
    Vec3d position_;
    double azimuth_ = 0.0;    ///< rad, from +X toward +Y
    double elevation_ = 0.0;  ///< rad
    double speed_ = 1.5;      ///< m/s: a walk
    double vfov_deg_ = 65.0;
};

}  // namespace glowworm
