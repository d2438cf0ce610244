#include "viewer/app/live_frame.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "viewer/frame/exposure.h"

namespace glowworm {
namespace {

constexpr double kExposureRate = 4.0;    // 1/s: how fast the eye adapts
constexpr double kMovingSeconds = 0.25;  // without input until the frame is drawn finely
constexpr double kSharpenSeconds = 0.6;  // without input until a coarse frame is made sharp
constexpr double kSameStops = 0.01;      // of exposure: no longer adapting
constexpr std::size_t kFramesRemembered = 120;
constexpr int kPickReach = 3;  // frame pixels searched round a hole
constexpr int kFineTile = 9;   // pixels drawn anew round a click, odd

}  // namespace

LiveFrame::LiveFrame(const Context& context, const OctreeView& octree,
                     const FrameSettings& settings, const GlfwWindow& window, WindowState& state,
                     ViewOfSize view_of_size)
    : context_(context),
      window_(window),
      state_(state),
      view_of_size_(std::move(view_of_size)),
      selection_(settings.selection),
      frame_(context, octree, settings) {}

bool LiveFrame::draw(const LiveLight* light, double resting) {
    const WindowExtent extent = window_.framebuffer();
    if (extent.width == 0 || extent.height == 0) return false;  // minimised
    const bool lit = light != nullptr;
    if (extent != paced_extent_ || lit != drawn_as_.lit) {
        pace_ = {};  // what was learnt holds for other pixels
        paced_extent_ = extent;
        stale_ = true;
    }
    const bool looks_alike = !sharpening_.active() || sharpened_as_ == look();
    stale_ = stale_ || drawn_as_ != surfaces(lit) || !looks_alike;
    const int divisor = pace_.divisor(resting < kMovingSeconds);
    if (!stale_ && divisor >= state_.divisor) return sharpen(light, resting);
    draw_whole(light, divisor);
    return true;
}

void LiveFrame::draw_whole(const LiveLight* light, int divisor) {
    sharpening_.stop();
    SelectionSettings selection = selection_;
    selection.quality = state_.pixels_between_points;
    frame_.set_selection(selection);
    frame_.set_wetness(state_.wetness);
    const WindowExtent extent = window_.framebuffer();
    const View view =
        view_of_size_(std::max(extent.width / divisor, 1), std::max(extent.height / divisor, 1));
    std::optional<PassTimer> timer;
    if (state_.measure_passes) timer.emplace(context_.device());
    PassTimer* const times = timer ? &*timer : nullptr;

    const auto begun = std::chrono::steady_clock::now();
    if (light != nullptr) {
        frame_.draw(view, light->field(), Frame::Missing::kAskFor, times);
    } else {
        frame_.draw_surfaces(view, Frame::Missing::kAskFor, times);
    }
    glFinish();
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begun;

    pace_.drawn(divisor, took.count());
    if (light != nullptr) {
        const auto luminances = display_.luminances(frame_.beauty(), view.width, view.height);
        if (!luminances.empty()) {
            wanted_exposure_ = measured_exposure(luminances);
            metered_ = true;
        }
    }
    drawn_ = view;
    drawn_as_ = surfaces(light != nullptr);
    stale_ = !frame_.is_complete();  // the next one is finer

    state_.frame_ms = took.count() * 1e3;
    state_.divisor = divisor;
    state_.points_drawn = frame_.surfels_drawn();
    state_.points_without_room = frame_.surfels_without_room();
    state_.frame_history.push_back(static_cast<float>(state_.frame_ms));
    if (state_.frame_history.size() > kFramesRemembered) {
        state_.frame_history.erase(state_.frame_history.begin());
    }
    if (!timer) return;
    state_.passes.clear();
    for (const auto& [name, samples] : timer->samples())
        state_.passes.emplace_back(name, samples.back().gpu_ms);
}

/// What stands still and was drawn coarsely becomes sharp, a tile a call; false where all is done.
bool LiveFrame::sharpen(const LiveLight* light, double resting) {
    const bool settled = light != nullptr && light->settled() && exposure_settled();
    const bool coarse = state_.divisor > 1 && !of_octree(state_.layer);  // whose cells are coarse
    if (!coarse || !settled || resting < kSharpenSeconds) return false;
    const WindowExtent extent = window_.framebuffer();
    if (!sharpening_.active()) {
        sharpening_.begin(canvas_.framebuffer(), drawn_.width, drawn_.height, extent.width,
                          extent.height);
        sharpened_as_ = look();
    }
    if (sharpening_.done()) return false;
    const auto [x, y] = sharpening_.tile();
    constexpr int kEdge = Sharpening::kTileEdge;
    frame_.draw(tile_of(view_of_size_(extent.width, extent.height), x, y, kEdge, kEdge),
                light->field(), Frame::Missing::kWaitFor);
    paint(state_.layer, &light->field(), sharpening_.target());
    sharpening_.put();
    return true;
}

LiveFrame::Surfaces LiveFrame::surfaces(bool lit) const {
    return {state_.pixels_between_points, state_.wetness, state_.clip, state_.clip_box, lit};
}

LiveFrame::Look LiveFrame::look() const {
    return {state_.layer, state_.curve, state_.automatic_exposure, state_.exposure};
}

bool LiveFrame::exposure_settled() const {
    return !state_.automatic_exposure || std::abs(wanted_exposure_ - state_.exposure) < kSameStops;
}

/// The eye adapts over a while, but not to the first picture.
void LiveFrame::adapt_exposure(double seconds) {
    if (!state_.automatic_exposure || !metered_) return;
    const double share = adapted_ ? 1.0 - std::exp(-kExposureRate * seconds) : 1.0;
    state_.exposure += static_cast<float>((wanted_exposure_ - state_.exposure) * share);
    adapted_ = true;
}

/// The frame as one of its layers shows it.
void LiveFrame::paint(Layer layer, const LightField* light, const Texture& target) {
    if (layer == Layer::kPicture) {
        display_.draw(frame_.beauty(), target, state_.exposure, state_.curve);
    } else {
        inspector_.draw(frame_, light, {layer, state_.level, state_.exposure, state_.curve},
                        target);
    }
}

bool LiveFrame::present(const LiveLight* light, double seconds) {
    const WindowExtent extent = window_.framebuffer();
    if (extent.width == 0 || extent.height == 0) return false;
    state_.sharpened = sharpening_.active() ? sharpening_.share_done() : 0.0;
    if (sharpening_.active()) {
        sharpening_.present();
        return true;
    }
    if (drawn_.width == 0) {  // the frame is used for something else: as it was shown last
        if (!canvas_.empty()) canvas_.present(extent.width, extent.height);
        return !canvas_.empty();
    }
    adapt_exposure(seconds);
    const Texture& target = canvas_.target(drawn_.width, drawn_.height);
    if (drawn_as_.lit && light != nullptr) {
        paint(state_.layer, &light->field(), target);
    } else {
        paint(Layer::kUnlit, nullptr, target);
    }
    canvas_.present(extent.width, extent.height);
    return true;
}

std::optional<SurfacePoint> LiveFrame::pick(double x, double y) {
    const WindowExtent screen = window_.screen();
    if (drawn_.width == 0 || screen.width == 0 || screen.height == 0) return std::nullopt;
    if (sharpening_.active()) return pick_in_tile(x, y);  // which the frame's surfaces are of
    const double frame_x = x * drawn_.width / screen.width;
    const double frame_y = y * drawn_.height / screen.height;
    // The nearest pixel that has a surface: thin gaps between points do not swallow a click.
    for (int reach = 0; reach <= kPickReach; ++reach) {
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                if (std::max(std::abs(dx), std::abs(dy)) != reach) continue;
                const double at_x = frame_x + dx, at_y = frame_y + dy;
                if (at_x < 0 || at_y < 0 || at_x >= drawn_.width || at_y >= drawn_.height) continue;
                const auto pixel =
                    static_cast<std::size_t>(at_y) * static_cast<std::size_t>(drawn_.width) +
                    static_cast<std::size_t>(at_x);
                const auto surface = frame_.gbuffer().surfaces().read<gpu::vec4>(1, pixel).front();
                if (const auto point = surface_point(drawn_, surface, at_x, at_y)) return point;
            }
        }
    }
    return std::nullopt;
}

std::optional<SurfacePoint> LiveFrame::pick_finely(double x, double y) {
    if (sharpening_.active()) return pick_in_tile(x, y);
    const auto coarse = pick(x, y);
    const auto fine = pick_in_tile(x, y);
    drawn_ = {};  // the frame's surfaces are gone
    stale_ = true;
    return fine ? fine : coarse;
}

/// From a few pixels drawn anew; the frame then holds them and nothing else.
std::optional<SurfacePoint> LiveFrame::pick_in_tile(double x, double y) {
    const WindowExtent screen = window_.screen();
    const int left = static_cast<int>(x) - kFineTile / 2, top = static_cast<int>(y) - kFineTile / 2;
    const View tile =
        tile_of(view_of_size_(screen.width, screen.height), left, top, kFineTile, kFineTile);
    frame_.draw_surfaces(tile, Frame::Missing::kWaitFor);
    constexpr std::size_t kMiddle = kFineTile / 2 * kFineTile + kFineTile / 2;
    const auto surface = frame_.gbuffer().surfaces().read<gpu::vec4>(1, kMiddle).front();
    return surface_point(tile, surface, x - left, y - top);
}

FrameLayers LiveFrame::render(const View& view, const LightField& light, const Progress& progress) {
    drawn_ = {};  // the frame's surfaces are going
    stale_ = true;
    return frame_.render(view, light, progress);
}

}  // namespace glowworm
