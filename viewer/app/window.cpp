#include "viewer/app/window.h"

#include <epoxy/gl.h>

#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "octree/error.h"
#include "viewer/app/canvas.h"
#include "viewer/app/console.h"
#include "viewer/app/default_scene.h"
#include "viewer/app/input.h"
#include "viewer/app/live_light.h"
#include "viewer/app/pace.h"
#include "viewer/app/panel.h"
#include "viewer/app/picture_file.h"
#include "viewer/app/start.h"
#include "viewer/frame/exposure.h"

namespace glowworm {
namespace {

constexpr double kRadiansPerPixel = 0.004;  // of mouse movement
constexpr double kExposureRate = 4.0;       // 1/s: how fast the eye adapts
constexpr double kRestSeconds = 0.25;       // without input until the frame is drawn finely
constexpr double kIdleSeconds = 0.05;       // waited for input where nothing changes
constexpr double kHeadlampStep = 0.25;      // m: the headlamp follows in steps

double now_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// GLFW and its one window, its context current.
class GlfwWindow {
  public:
    GlfwWindow(const std::string& title, int width, int height) {
        if (glfwInit() != GLFW_TRUE) {
            throw Error(ExitCode::kInternal,
                        "there is no display to open a window on; --headless renders without one");
        }
        glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
        glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
        glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
        window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
        if (window_ == nullptr) {
            glfwTerminate();
            throw Error(ExitCode::kInternal,
                        "this display offers no OpenGL 4.5; --headless renders without it");
        }
        glfwMakeContextCurrent(window_);
        glfwSwapInterval(1);
    }
    GlfwWindow(const GlfwWindow&) = delete;
    GlfwWindow& operator=(const GlfwWindow&) = delete;
    ~GlfwWindow() { glfwTerminate(); }
    GLFWwindow* get() const { return window_; }

  private:
    GLFWwindow* window_ = nullptr;
};

/// The default scene's headlamp becomes the one that moves with the camera.
bool take_headlamp(Scene& scene) {
    return std::erase_if(scene.point_lights,
                         [](const PointLight& l) { return l.name == "headlamp"; }) > 0;
}

PanelState panel_state_of(const Options& options, Scene& scene) {
    PanelState state;
    state.headlamp_on = take_headlamp(scene);
    state.lamps = lamp_controls(scene);
    state.curve = options.display.curve;
    state.automatic_exposure = !options.display.exposure;
    state.exposure = static_cast<float>(options.display.exposure.value_or(0.0));
    return state;
}

class Session {
  public:
    Session(const Options& options, const Cave& cave)
        : options_(options),
          cave_(cave),
          start_(start_of(cave.points(), options.scene, options.camera)),
          state_(panel_state_of(options, start_.scene)),
          window_("Glowworm - " + options.octree.filename().string(),
                  options.size ? options.size->width : 1280,
                  options.size ? options.size->height : 800),
          context_(Context::of_window()),
          camera_(start_.camera),
          light_(context_, cave.light(), lit_scene(), options.light, options.bounces),
          frame_(context_, cave.points(), options.frame),
          listening_((listen(window_.get(), input_), true)),
          panel_(window_.get()) {
        frame_.set_panels(lit_scene().area_lights);
        spdlog::debug("drawing on {}, OpenGL {}", context_.device().renderer,
                      context_.device().version);
    }

    void run() {
        double before = now_seconds();
        while (glfwWindowShouldClose(window_.get()) == 0 && !cancel_requested() &&
               (!options_.frames || shown_ < *options_.frames)) {
            const double seconds = std::min(now_seconds() - before, 0.25);
            before = now_seconds();
            cave_.file.require_intact();
            glfwPollEvents();
            take_input(seconds);
            move_headlamp();
            stale_ = light_.advance() || stale_;
            if (!draw_frame()) glfwWaitEventsTimeout(kIdleSeconds);
            show(seconds);
        }
    }

  private:
    Scene lit_scene() const {
        Scene scene = controlled_scene(start_.scene, state_.lamps);
        if (state_.headlamp_on) {
            Camera eye = start_.camera;
            eye.position = headlamp_eye_;
            scene.point_lights.push_back(headlamp_at(eye, state_.headlamp_intensity));
        }
        return scene;
    }

    void relight() {
        const Scene scene = lit_scene();
        light_.set_scene(scene);
        frame_.set_panels(scene.area_lights);
        stale_ = true;
    }

    void take_input(double seconds) {
        for (const int key : input_.pressed) {
            if (!panel_.wants_keyboard()) press(key);
        }
        if (!panel_.wants_mouse()) {
            camera_.turn(input_.drag_x * kRadiansPerPixel, -input_.drag_y * kRadiansPerPixel);
            camera_.change_speed(input_.wheel);
        }
        const FlyInput held = panel_.wants_keyboard() ? FlyInput{} : held_keys(window_.get());
        camera_.move(held, seconds);
        const bool moved = held.ahead != 0 || held.aside != 0 || held.rise != 0 ||
                           input_.drag_x != 0 || input_.drag_y != 0;
        if (moved) moved_at_ = now_seconds();
        stale_ = stale_ || moved || input_.damaged;
        input_.pressed.clear();
        input_.wheel = input_.drag_x = input_.drag_y = 0.0;
        input_.damaged = false;
        state_.speed = static_cast<float>(camera_.speed());
    }

    void press(int key) {
        if (key == GLFW_KEY_ESCAPE) glfwSetWindowShouldClose(window_.get(), GLFW_TRUE);
        if (key == GLFW_KEY_TAB) state_.visible = !state_.visible;
        if (key == GLFW_KEY_F1) state_.show_keys = !state_.show_keys;
        if (key == GLFW_KEY_F12) save_picture();
        if (key == GLFW_KEY_H) {
            state_.headlamp_on = !state_.headlamp_on;
            relight();
        }
    }

    /// Where injecting light takes long, the headlamp follows when the camera rests.
    void move_headlamp() {
        const Vec3d eye = camera_.camera(1, 1).position;
        if (!state_.headlamp_on || length(eye - headlamp_eye_) < kHeadlampStep) return;
        if (relight_seconds_ > kRestSeconds && resting_seconds() < kRestSeconds) return;
        headlamp_eye_ = eye;
        const double begun = now_seconds();
        relight();
        glFinish();
        relight_seconds_ = now_seconds() - begun;
    }

    double resting_seconds() const { return now_seconds() - moved_at_; }

    View view_of_size(int width, int height) const {
        return view_of(camera_.camera(width, height));
    }

    /// Draws where something has changed, or finer where there is time; false where not.
    bool draw_frame() {
        int window_width = 0, window_height = 0;
        glfwGetFramebufferSize(window_.get(), &window_width, &window_height);
        if (window_width == 0 || window_height == 0) return false;  // minimised
        const int divisor = pace_.divisor(resting_seconds() < kRestSeconds);
        if (!stale_ && divisor >= state_.divisor) return false;
        const double begun = now_seconds();
        width_ = std::max(window_width / divisor, 1);
        height_ = std::max(window_height / divisor, 1);
        frame_.draw(view_of_size(width_, height_), light_.field());
        glFinish();
        const double seconds = now_seconds() - begun;
        pace_.drawn(divisor, seconds);
        state_.frame_ms = seconds * 1e3;
        state_.divisor = divisor;
        stale_ = false;
        wanted_exposure_ = measured_exposure(display_.luminances(frame_.beauty(), width_, height_));
        return true;
    }

    /// The eye adapts over a while, but not to the first picture.
    void adapt_exposure(double seconds) {
        if (!state_.automatic_exposure) return;
        const double share = adapted_once_ ? 1.0 - std::exp(-kExposureRate * seconds) : 1.0;
        state_.exposure += static_cast<float>((wanted_exposure_ - state_.exposure) * share);
        adapted_once_ = true;
    }

    void show(double seconds) {
        if (width_ == 0) return;
        adapt_exposure(seconds);
        int window_width = 0, window_height = 0;
        glfwGetFramebufferSize(window_.get(), &window_width, &window_height);
        canvas_.show(display_, frame_.beauty(), width_, height_, state_.exposure, state_.curve);
        canvas_.present(window_width, window_height);
        state_.light_status = light_.status();
        if (panel_.draw(state_)) relight();
        glfwSwapBuffers(window_.get());
        if (shown_ == 0)
            spdlog::debug("the first picture after {:.2f} s", now_seconds() - opened_at_);
        if (shown_ < std::numeric_limits<int>::max()) ++shown_;
    }

    /// The next free glowworm-N.png and .exr in the current folder, at the window's size.
    void save_picture() {
        int width = 0, height = 0;
        glfwGetFramebufferSize(window_.get(), &width, &height);
        if (width == 0 || height == 0) return;
        int number = 1;
        while (std::filesystem::exists(fmt::format("glowworm-{}.png", number)))
            ++number;
        const std::string name = fmt::format("glowworm-{}", number);
        try {
            const View view = view_of_size(width, height);
            const FrameLayers layers = frame_.render(view, light_.field());
            const DisplaySettings shown{state_.exposure, state_.curve};
            write_frame(layers, view, shown, name + ".exr");
            write_frame(layers, view, shown, name + ".png");
            state_.message = fmt::format("saved {0}.png and {0}.exr", name);
        } catch (const Error& error) {
            state_.message = error.what();
        }
        stale_ = true;
    }

    const double opened_at_ = now_seconds();
    const Options& options_;
    const Cave& cave_;
    Start start_;
    PanelState state_;
    Vec3d headlamp_eye_ = start_.camera.position;
    GlfwWindow window_;
    Context context_;
    FlyCamera camera_;
    LiveLight light_;
    Frame frame_;
    Input input_;
    bool listening_;  // before the panel, which passes events on
    Panel panel_;
    Display display_;
    Canvas canvas_;
    Pace pace_;

    int shown_ = 0;                 // pictures
    int width_ = 0, height_ = 0;    // of the drawn frame
    double moved_at_ = 0.0;         // s, of now_seconds()
    double relight_seconds_ = 0.0;  // how long the last one took
    double wanted_exposure_ = 0.0;
    bool stale_ = true;  // what is drawn is not what would be seen
    bool adapted_once_ = false;
};

}  // namespace

void run_window(const Options& options, const Cave& cave) {
    Session(options, cave).run();
}

}  // namespace glowworm
