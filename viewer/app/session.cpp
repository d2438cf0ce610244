// Drawing, and light that propagates meanwhile.
#include "viewer/app/session.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <new>

#include "octree/error.h"
#include "viewer/app/console.h"
#include "viewer/app/default_scene.h"

namespace glowworm {
namespace {

constexpr double kIdleSeconds = 0.05;    // waited for input where nothing changes
constexpr double kStirredSeconds = 2.0;  // shown on after anything happened
constexpr double kRestSeconds = 0.25;    // without input
constexpr double kHeadlampStep = 0.25;   // m: the headlamp follows in steps

std::optional<WindowExtent> extent_of(const Options& options) {
    if (!options.size) return std::nullopt;
    return WindowExtent{options.size->width, options.size->height};
}

}  // namespace

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

Session::Session(const Options& options, const Cave& cave, Beginning beginning)
    : opened_at_(now_seconds()),
      options_(options),
      cave_(cave),
      scene_(std::move(beginning.start.scene)),
      start_camera_(beginning.start.camera),
      state_(std::move(beginning.state)),
      history_(std::move(beginning.history)),
      navigator_(std::move(beginning.navigator)),
      window_("Glowworm - " + options.octree.filename().string(), extent_of(options)),
      context_(Context::of_window()),
      frame_(context_, cave.points(), options.frame, window_, state_,
             [this](int width, int height) { return view_of_size(width, height); }),
      panel_(window_.get()),
      headlamp_eye_(navigator_.camera().position()),
      stepped_at_(opened_at_) {
    frame_.set_panels(lit_scene().area_lights);
    navigator_.set_screen_height(std::max(window_.screen().height, 1));
    if (!beginning.resumed) {
        if (navigator_.in_survey()) carry_out({Command::kPlan});  // of the window's size
        damage_check_.emplace(cave.file);
    }
    spdlog::debug("drawing on {}, OpenGL {}", context_.device().renderer,
                  context_.device().version);
}

SessionEnd Session::run() {
    bool lost = false;
    try {
        while (goes_on() && !lost) {
            step();
            longest_step_ = std::max(longest_step_, now_seconds() - stepped_at_);
            lost = window_.context_lost();
        }
    } catch (const Error&) {  // what a context says that is no more there does not count
        lost = window_.context_lost();
        if (!lost) throw;
    }
    spdlog::debug("the longest time between two looks for input {:.2f} s", longest_step_);
    if (next_) return std::move(*next_);
    if (!lost) return WindowClosed{};
    spdlog::warn("the graphics driver was reset: opening the window anew");
    say("the graphics driver was reset, and the window was opened anew");
    return Beginning{{std::move(scene_), start_camera_},
                     std::move(state_),
                     std::move(navigator_),
                     std::move(history_),
                     true};
}

bool Session::goes_on() const {
    return !window_.should_close() && !cancel_requested() && !next_ &&
           (!options_.frames || shown_ < *options_.frames);
}

/// One turn of the loop: points come first, then the light on them.
void Session::step() {
    window_.poll(idle_ ? kIdleSeconds : 0.0);
    const double seconds = std::min(now_seconds() - stepped_at_, 0.25);
    stepped_at_ = now_seconds();
    look_for_damage();
    take_input(seconds);
    move_headlamp();
    const bool drawn = draw();
    const bool coming = light_wanted_ || ground_.valid();
    const bool settled = !coming && (!light_ || light_->settled());
    idle_ = !drawn && (settled || !light_ || !light_->injecting());
    if (window_.input().take_stir() || drawn || !settled) stirred_at_ = now_seconds();
    // For a while longer: the exposure settles, the panel answers.
    const bool stirred = now_seconds() - stirred_at_ < kStirredSeconds;
    if (stirred || panel_.is_editing() || options_.frames) show(seconds);
}

/// What is drawn of a file that was cut meanwhile is not shown: the last picture stays.
bool Session::draw() {
    if (!intact_) return false;
    step_light();
    const bool drawn = frame_.draw(light_.get(), resting_seconds());
    look_for_cut();
    if (!intact_) frame_.hold();
    return drawn;
}

/// What is wrong with the file is said; what there is of it is shown.
void Session::look_for_damage() {
    const auto damage = damage_check_ ? damage_check_->take() : std::nullopt;
    if (!damage) return;
    damage_check_.reset();
    warn_of_damage(options_.octree, *damage);
    for (const std::string& sentence : *damage)
        state_.file_facts += "\nDAMAGED: " + sentence;
    if (damage->empty()) return;
    say(fmt::format("'{}' is damaged: {}; what is shown of it may be wrong",
                    options_.octree.string(), damage->front()));
}

void Session::look_for_cut() {
    try {
        cave_.file.require_intact();
    } catch (const Error& error) {
        intact_ = false;
        spdlog::error(error.what());
        state_.file_facts += fmt::format("\nDAMAGED: {}", error.what());
        say(fmt::format("{}, and drop it here: until then the picture stays as it is",
                        error.what()));
    }
}

View Session::view_of_size(int width, int height) const {
    View view = navigator_.view(width, height);
    if (state_.clip) view.clip = state_.clip_box;
    return view;
}

Scene Session::lit_scene() const {
    Scene scene = with_lamps(scene_, state_.lamps);
    if (state_.headlamp_on) {
        Camera eye = start_camera_;
        eye.position = headlamp_eye_;
        eye.up = {0, 0, 1};
        scene.point_lights.push_back(headlamp_at(eye, state_.headlamp_intensity));
    }
    return scene;
}

Session::LitBy Session::lit_by() const {
    return {state_.lamps, state_.headlamp_on, state_.headlamp_intensity, headlamp_eye_};
}

/// One step of undoing is all that was done until the mouse let go.
void Session::relight_if_changed() {
    if (dragged_lamp_ < 0 && !panel_.is_editing()) history_.record(state_.lamps);
    state_.can_undo = history_.can_undo();
    state_.can_redo = history_.can_redo();
    if (!light_ || lit_by_ == lit_by()) return;
    const Scene scene = lit_scene();
    light_->set_scene(scene);
    frame_.set_panels(scene.area_lights);
    lit_by_ = lit_by();
    frame_.spoil();
}

void Session::move_headlamp() {
    const Vec3d eye = navigator_.camera().position();
    if (state_.headlamp_on && length(eye - headlamp_eye_) > kHeadlampStep) headlamp_eye_ = eye;
}

/// Where light cannot be had the points stay to be seen.
void Session::step_light() {
    const auto give_up = [&](const std::string& sentence) {
        light_.reset();
        frame_.spoil();
        spdlog::error(sentence);
        say(sentence);
    };
    try {
        if (light_wanted_ && shown_ > 0) begin_light();
        if (ground_.valid() &&
            ground_.wait_for(std::chrono::seconds(0)) == std::future_status::ready)
            make_light(ground_.get());
        relight_if_changed();
        // What takes long waits until nothing moves.
        const bool waits = light_ && light_->injecting() && resting_seconds() < kRestSeconds;
        if (light_) light_->look_from(navigator_.camera().position());
        if (light_ && !waits && light_->advance()) frame_.spoil();
    } catch (const Error& error) {
        give_up(error.what());
    } catch (const std::bad_alloc&) {
        give_up(
            "there is not enough memory for the light of this cave: --light-memory says how "
            "much it may take");
    }
}

/// Works out beside the window's thread what light stands on.
void Session::begin_light() {
    if (ground_.valid()) return;
    light_wanted_ = false;
    light_.reset();
    ground_ = std::async(std::launch::async, [this] { return ground(); });
}

LightGround Session::ground() const {
    return make_light_ground(cave_.light(), {}, runs_compiled(context_, {}));
}

/// Light as the settings say, from the beginning.
void Session::make_light(LightGround ground) {
    light_wanted_ = false;
    const auto bounces = state_.limit_bounces ? std::optional(state_.bounces) : std::nullopt;
    const Scene scene = lit_scene();
    light_ = std::make_unique<LiveLight>(context_, cave_.light(), scene, state_.light, bounces,
                                         cave_.light_groups, std::move(ground));
    frame_.set_panels(scene.area_lights);
    lit_by_ = lit_by();
    frame_.spoil();
    spdlog::debug("light after {:.2f} s", now_seconds() - opened_at_);
}

double Session::resting_seconds() const {
    return now_seconds() - moved_at_;
}

void Session::moved() {
    moved_at_ = now_seconds();
    frame_.spoil();
}

/// In the window, and for those who read the log.
void Session::say(const std::string& sentence) {
    state_.message = sentence;
    stirred_at_ = now_seconds();
    spdlog::debug("{}", sentence);
}

void Session::show(double seconds) {
    if (!frame_.present(light_.get(), seconds)) return;
    state_.light_status = light_ ? light_->status() : "none yet";
    state_.residuals = light_ ? light_->residuals() : std::vector<float>{};
    state_.mode = navigator_.mode();
    state_.scheme = navigator_.scheme();
    state_.speed = static_cast<float>(navigator_.camera().speed());
    state_.vfov_deg = static_cast<float>(navigator_.camera().vfov_deg());
    const WindowExtent screen = window_.screen();
    panel_.draw(state_, view_of_size(screen.width, screen.height), window_.units_scale());
    window_.swap();
    if (shown_ == 0) spdlog::debug("the first picture after {:.2f} s", now_seconds() - opened_at_);
    if (shown_ < std::numeric_limits<int>::max()) ++shown_;
}

}  // namespace glowworm
