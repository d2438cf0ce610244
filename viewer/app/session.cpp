#include "viewer/app/session.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "viewer/app/console.h"
#include "viewer/app/default_scene.h"
#include "viewer/app/file_facts.h"
#include "viewer/frame/exposure.h"

namespace glowworm {
namespace {

constexpr double kExposureRate = 4.0;    // 1/s: how fast the eye adapts
constexpr double kRestSeconds = 0.25;    // without input until the frame is drawn finely
constexpr double kSharpenSeconds = 0.6;  // without input until a coarse frame is made sharp
constexpr double kSameStops = 0.01;      // of exposure: no longer adapting
constexpr double kIdleSeconds = 0.05;    // waited for input where nothing changes
constexpr double kHeadlampStep = 0.25;   // m: the headlamp follows in steps
constexpr std::size_t kFramesRemembered = 120;

WindowState state_of(const Options& options, const Cave& cave, Scene& scene) {
    WindowState state;
    const auto headlamp = take_headlamp(scene);
    state.headlamp_on = headlamp.has_value();
    if (headlamp) state.headlamp_intensity = headlamp->radiant_intensity;
    state.lamps = lamps_of(scene);
    state.curve = options.display.curve;
    state.automatic_exposure = !options.display.exposure;
    state.exposure = static_cast<float>(options.display.exposure.value_or(0.0));
    state.pixels_between_points = options.frame.selection.quality;
    state.wetness = options.frame.wetness;
    state.level = static_cast<int>(cave.light().grid.depth);
    state.levels = state.level + 1;
    state.scheme = options.controls;
    state.light = options.light;
    state.limit_bounces = options.bounces.has_value();
    state.bounces = options.bounces.value_or(state.bounces);
    for (const StationRecord& station : cave.points().stations) {
        state.stations.push_back(
            {std::string(cave.points().names.substr(station.name_offset, station.name_bytes)),
             {station.position[0], station.position[1], station.position[2]}});
    }
    state.file_facts = file_facts(options.octree, cave);
    state.scene_file = options.scene.empty() ? "glowworm-scene.json" : options.scene.string();
    return state;
}

}  // namespace

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Session::Session(const Options& options, const Cave& cave)
    : opened_at_(now_seconds()),
      options_(options),
      cave_(cave),
      start_(start_of(cave.points(), options.scene, options.camera)),
      state_(state_of(options, cave, start_.scene)),
      history_(state_.lamps),
      window_("Glowworm - " + options.octree.filename().string(),
              options.size ? options.size->width : 1280, options.size ? options.size->height : 800),
      context_(Context::of_window()),
      navigator_(cave.points(), start_.camera, options.controls),
      headlamp_eye_(start_.camera.position),
      light_settings_(options.light),
      frame_(context_, cave.points(), options.frame),
      panel_(window_.get()) {
    rebuild_light();
    state_.clip_box = navigator_.bounds();
    state_.vfov_deg = static_cast<float>(navigator_.camera().vfov_deg());
    navigator_.set_screen_height(std::max(window_.screen().height, 1));
    if (navigator_.in_survey()) carry_out({Command::kPlan});
    spdlog::debug("drawing on {}, OpenGL {}", context_.device().renderer,
                  context_.device().version);
}

std::optional<NextCave> Session::run() {
    double before = now_seconds();
    bool idle = false;
    while (!window_.should_close() && !cancel_requested() && !next_ &&
           (!options_.frames || shown_ < *options_.frames)) {
        window_.poll(idle ? kIdleSeconds : 0.0);
        const double seconds = std::min(now_seconds() - before, 0.25);
        before = now_seconds();
        cave_.file.require_intact();
        take_input(seconds);
        move_headlamp();
        relight_if_changed();
        stale_ = light_->advance() || stale_;
        idle = !draw_frame() && !light_->injecting();
        show(seconds);
    }
    return std::move(next_);
}

View Session::view_of_size(int width, int height) const {
    View view = navigator_.view(width, height);
    if (state_.clip) view.clip = state_.clip_box;
    return view;
}

Scene Session::lit_scene() const {
    Scene scene = with_lamps(start_.scene, state_.lamps);
    if (state_.headlamp_on) {
        Camera eye = start_.camera;
        eye.position = headlamp_eye_;
        eye.up = {0, 0, 1};
        scene.point_lights.push_back(headlamp_at(eye, state_.headlamp_intensity));
    }
    return scene;
}

/// While something is dragged and light takes long, it follows when the mouse lets go.
void Session::relight_if_changed() {
    const bool same = state_.lamps == lit_lamps_ && state_.headlamp_on == lit_headlamp_ &&
                      state_.headlamp_intensity == lit_headlamp_intensity_ &&
                      (headlamp_eye_ == lit_eye_ || !state_.headlamp_on);
    const bool busy = dragged_lamp_ >= 0 || panel_.is_editing();
    if (!busy) history_.record(state_.lamps);
    state_.can_undo = history_.can_undo();
    state_.can_redo = history_.can_redo();
    if (same || (busy && relight_seconds_ > kRestSeconds)) return;
    const double begun = now_seconds();
    const Scene scene = lit_scene();
    light_->set_scene(scene);
    frame_.set_panels(scene.area_lights);
    glFinish();
    relight_seconds_ = now_seconds() - begun;
    lit_lamps_ = state_.lamps;
    lit_headlamp_ = state_.headlamp_on;
    lit_headlamp_intensity_ = state_.headlamp_intensity;
    lit_eye_ = headlamp_eye_;
    stale_ = true;
}

/// Where injecting light takes long, the headlamp follows when the camera rests.
void Session::move_headlamp() {
    const Vec3d eye = navigator_.camera().position();
    if (!state_.headlamp_on || length(eye - headlamp_eye_) < kHeadlampStep) return;
    if (relight_seconds_ > kRestSeconds && resting_seconds() < kRestSeconds) return;
    headlamp_eye_ = eye;
}

double Session::resting_seconds() const {
    return now_seconds() - moved_at_;
}

void Session::moved() {
    moved_at_ = now_seconds();
    stale_ = true;
}

/// Draws where something has changed, or finer where there is time; false where not.
bool Session::draw_frame() {
    const WindowExtent extent = window_.framebuffer();
    if (extent.width == 0 || extent.height == 0) return false;  // minimised
    if (extent != paced_extent_) {
        pace_ = {};  // what was learnt holds for other pixels
        paced_extent_ = extent;
        stale_ = true;
    }
    const int divisor = pace_.divisor(resting_seconds() < kRestSeconds);
    stale_ = stale_ || drawn_as_ != surfaces() || (sharpening_.active() && sharpened_as_ != look());
    if (!stale_ && divisor >= state_.divisor) return sharpen(extent);
    sharpening_.stop();
    SelectionSettings selection = options_.frame.selection;
    selection.quality = state_.pixels_between_points;
    frame_.set_selection(selection);
    frame_.set_wetness(state_.wetness);
    const double begun = now_seconds();
    const View view =
        view_of_size(std::max(extent.width / divisor, 1), std::max(extent.height / divisor, 1));
    std::optional<PassTimer> timer;
    if (state_.measure_passes) timer.emplace(context_.device());
    frame_.draw(view, light_->field(), Frame::Missing::kAskFor, timer ? &*timer : nullptr);
    glFinish();
    const double seconds = now_seconds() - begun;
    pace_.drawn(divisor, seconds);
    drawn_ = view;
    drawn_as_ = surfaces();
    stale_ = !frame_.is_complete();  // the next one is finer
    const auto luminances = display_.luminances(frame_.beauty(), view.width, view.height);
    if (!luminances.empty()) wanted_exposure_ = measured_exposure(luminances);

    state_.frame_ms = seconds * 1e3;
    state_.divisor = divisor;
    state_.points_drawn = frame_.surfels_drawn();
    state_.frame_history.push_back(static_cast<float>(state_.frame_ms));
    if (state_.frame_history.size() > kFramesRemembered) {
        state_.frame_history.erase(state_.frame_history.begin());
    }
    if (timer) {
        state_.passes.clear();
        for (const auto& [name, samples] : timer->samples())
            state_.passes.emplace_back(name, samples.back().gpu_ms);
    }
    return true;
}

/// What stands still and was drawn coarsely becomes sharp, a tile a call; false where all is done.
bool Session::sharpen(const WindowExtent& window) {
    const bool settled = light_->settled() && exposure_settled();
    const bool still = resting_seconds() > kSharpenSeconds;
    if (state_.divisor == 1 || state_.layer != Layer::kPicture || !settled || !still) return false;
    if (!sharpening_.active()) {
        sharpening_.begin(canvas_.framebuffer(), drawn_.width, drawn_.height, window.width,
                          window.height);
        sharpened_as_ = look();
    }
    if (sharpening_.done()) return false;
    const auto [x, y] = sharpening_.tile();
    constexpr int kEdge = Sharpening::kTileEdge;
    frame_.draw(tile_of(view_of_size(window.width, window.height), x, y, kEdge, kEdge),
                light_->field(), Frame::Missing::kWaitFor);
    display_.draw(frame_.beauty(), sharpening_.target(), state_.exposure, state_.curve);
    sharpening_.put();
    return true;
}

Session::Surfaces Session::surfaces() const {
    return {state_.pixels_between_points, state_.wetness, state_.clip, state_.clip_box};
}

Session::Look Session::look() const {
    return {state_.layer, state_.curve, state_.automatic_exposure, state_.exposure};
}

bool Session::exposure_settled() const {
    return !state_.automatic_exposure || std::abs(wanted_exposure_ - state_.exposure) < kSameStops;
}

/// The eye adapts over a while, but not to the first picture.
void Session::adapt_exposure(double seconds) {
    if (!state_.automatic_exposure || sharpening_.active()) return;
    const double share = adapted_once_ ? 1.0 - std::exp(-kExposureRate * seconds) : 1.0;
    state_.exposure += static_cast<float>((wanted_exposure_ - state_.exposure) * share);
    adapted_once_ = true;
}

void Session::present(const WindowExtent& window) {
    if (sharpening_.active()) {
        sharpening_.present();
        return;
    }
    const Texture& target = canvas_.target(drawn_.width, drawn_.height);
    if (state_.layer == Layer::kPicture) {
        display_.draw(frame_.beauty(), target, state_.exposure, state_.curve);
    } else {
        inspector_.draw(frame_, light_->field(),
                        {state_.layer, state_.level, state_.exposure, state_.curve}, target);
    }
    canvas_.present(window.width, window.height);
}

void Session::show(double seconds) {
    const WindowExtent pixels = window_.framebuffer(), screen = window_.screen();
    if (drawn_.width == 0 || pixels.width == 0 || pixels.height == 0) return;  // minimised
    adapt_exposure(seconds);
    present(pixels);

    state_.sharpened = sharpening_.active() ? sharpening_.share_done() : 0.0;
    state_.light_status = light_->status();
    state_.residuals = light_->residuals();
    state_.mode = navigator_.mode();
    state_.scheme = navigator_.scheme();
    state_.speed = static_cast<float>(navigator_.camera().speed());
    state_.vfov_deg = static_cast<float>(navigator_.camera().vfov_deg());
    panel_.draw(state_, view_of_size(screen.width, screen.height));
    window_.swap();
    if (shown_ == 0) spdlog::debug("the first picture after {:.2f} s", now_seconds() - opened_at_);
    if (shown_ < std::numeric_limits<int>::max()) ++shown_;
}

}  // namespace glowworm
