#pragma once

#include <optional>

#include "octree/octree_file.h"
#include "viewer/app/controls.h"
#include "viewer/app/fly_camera.h"
#include "viewer/app/survey_view.h"

namespace glowworm {

/// What a window looks through and how that moves: a camera that flies, orbits or walks, or a
/// survey view. The octree must outlive it.
class Navigator {
  public:
    Navigator(const OctreeView& octree, const Camera& start, ControlScheme scheme);

    ControlScheme scheme() const { return scheme_; }
    MoveMode mode() const { return mode_; }
    bool in_survey() const { return mode_ == MoveMode::kSurvey; }
    FlyCamera& camera() { return camera_; }
    const FlyCamera& camera() const { return camera_; }
    SurveyView& survey() { return survey_; }
    /// The whole cave, m, world.
    WorldBox bounds() const;
    /// What is drawn into a picture of that size: the same, more or less finely.
    View view(int width, int height) const;
    /// The window's height in screen units, in which the mouse moves: the pixels of a survey.
    void set_screen_height(int height) { screen_height_ = height; }

    void set_scheme(ControlScheme scheme);
    /// Out of a survey view the camera is where it was.
    void set_mode(MoveMode mode) { mode_ = mode; }
    /// The whole cave from above (tilt -90) or from the side (0); `width` x `height` pixels.
    void show_survey(double tilt_deg, int width, int height);
    void face(double bearing_deg);
    /// To where it started; a survey shows the whole cave again.
    void reset(int width, int height);
    void go_to(const Camera& camera);
    void toggle_rotation() { rotating_ = !rotating_; }
    bool rotating() const { return rotating_ && in_survey(); }

    /// Moves with held keys, and turns a survey that rotates. True where anything moved.
    bool step(const FlyInput& held, double seconds);
    /// A drag by pixels; `point` is what was under the cursor when it began, or was chosen to be
    /// turned round.
    void drag(DragAction action, double right, double down, const std::optional<Vec3d>& point,
              const View& view);
    /// The wheel, the cursor at (x, y) pixels and over `point`. True where the picture changes.
    bool wheel(double notches, double x, double y, const std::optional<Vec3d>& point,
               const View& view);

  private:
    OctreeView octree_;
    Camera start_;
    ControlScheme scheme_;
    MoveMode mode_;
    FlyCamera camera_;
    SurveyView survey_;
    int screen_height_;
    bool rotating_ = false;
};

}  // namespace glowworm
