#pragma once

#include <functional>
#include <optional>
#include <span>

#include "viewer/app/canvas.h"
#include "viewer/app/glfw_window.h"
#include "viewer/app/live_light.h"
#include "viewer/app/pace.h"
#include "viewer/app/pick.h"
#include "viewer/app/sharpening.h"
#include "viewer/app/window_state.h"

namespace glowworm {

/// The picture in a window: as coarse as it must be to follow what moves, sharp tile by tile when
/// nothing does. Until there is light it shows the points by themselves.
class LiveFrame {
  public:
    using ViewOfSize = std::function<View(int width, int height)>;

    /// `state` says what is wanted, and is told what it took; `view_of_size` what a picture of that
    /// many pixels shows. The octree, the window and the state must outlive it.
    LiveFrame(const Context& context, const OctreeView& octree, const FrameSettings& settings,
              const GlfwWindow& window, WindowState& state, ViewOfSize view_of_size);

    void set_panels(std::span<const AreaLight> panels) { frame_.set_panels(panels); }
    /// What is drawn is not what would be seen any more.
    void spoil() { stale_ = true; }

    /// The picture stays what was shown last, until the next draw().
    void hold() { drawn_ = {}; }

    /// Draws where something has changed, or finer where there is time; `resting` s without
    /// movement. `light`: nullptr where there is none yet. False where there was nothing to do.
    bool draw(const LiveLight* light, double resting);
    /// Copies what was drawn over the window's pixels, exposed as after `seconds` more; what was
    /// shown last where the frame is used for something else. False where nothing was drawn or
    /// nothing is to be seen (minimised).
    bool present(const LiveLight* light, double seconds);

    /// The surface under a place of the window, screen units, as the last frame shows it.
    std::optional<SurfacePoint> pick(double x, double y);
    /// The same as the whole cloud shows it at the window's own resolution, however coarse the
    /// frame is.
    std::optional<SurfacePoint> pick_finely(double x, double y);
    /// m from the eye that the last frame was seen with.
    double distance_to(const Vec3d& point) const { return length(point - drawn_.position); }

    /// All layers at the window's size and full quality.
    FrameLayers render(const View& view, const LightField& light, const Progress& progress);

  private:
    /// What of the cave is drawn, and how.
    struct Surfaces {
        float pixels_between_points = 0.0f, wetness = 0.0f;
        bool clip = false;
        WorldBox clip_box;
        bool lit = false;
        bool operator==(const Surfaces&) const = default;
    };
    /// What a picture looks like, beside what is in it.
    struct Look {
        Layer layer = Layer::kPicture;
        ToneCurve curve = ToneCurve::kAgx;
        bool automatic_exposure = true;
        float exposure = 0.0f;
        bool operator==(const Look&) const = default;
    };

    Surfaces surfaces(bool lit) const;
    Look look() const;
    void draw_whole(const LiveLight* light, int divisor);
    bool sharpen(const LiveLight* light, double resting);
    void paint(Layer layer, const LightField* light, const Texture& target);
    bool exposure_settled() const;
    void adapt_exposure(double seconds);
    std::optional<SurfacePoint> pick_in_tile(double x, double y);

    const Context& context_;
    const GlfwWindow& window_;
    WindowState& state_;
    const ViewOfSize view_of_size_;
    SelectionSettings selection_;
    Frame frame_;
    Display display_;
    Inspector inspector_;
    Canvas canvas_;
    Sharpening sharpening_;
    Pace pace_;
    WindowExtent paced_extent_;  // the window that it was learnt in

    View drawn_;  // what the frame shows; no pixels: nothing
    Surfaces drawn_as_;
    Look sharpened_as_;
    bool stale_ = true;
    double wanted_exposure_ = 0.0;
    bool metered_ = false, adapted_ = false;
};

}  // namespace glowworm
