#include "viewer/gpu/context.h"

// epoxy before EGL, as it replaces the GL headers.
#include <epoxy/gl.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "octree/error.h"

namespace glowworm {

struct Context::State {
    EGLDisplay display = EGL_NO_DISPLAY;  // none for a window's context
    EGLContext context = EGL_NO_CONTEXT;
    GlDevice device;
    std::vector<std::string> errors;

    ~State() {
        if (context != EGL_NO_CONTEXT) {
            eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
            eglDestroyContext(display, context);
        } else if (!device.version.empty()) {
            glDebugMessageCallback(nullptr, nullptr);
        }
        if (display != EGL_NO_DISPLAY) eglTerminate(display);
    }
};

namespace {

constexpr std::size_t kMaxErrorsKept = 100;

template <typename F>
F egl_function(const char* name) {
    return reinterpret_cast<F>(eglGetProcAddress(name));
}

bool has_extension(const char* list, std::string_view name) {
    return list != nullptr && std::string_view(list).find(name) != std::string_view::npos;
}

/// A debug context of OpenGL 4.5 core on `display`, current on this thread; none where refused.
EGLContext make_current_on(EGLDisplay display) {
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
        return EGL_NO_CONTEXT;
    }
    eglBindAPI(EGL_OPENGL_API);
    constexpr std::array attributes = {EGL_CONTEXT_MAJOR_VERSION,
                                       4,
                                       EGL_CONTEXT_MINOR_VERSION,
                                       5,
                                       EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                       EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                       EGL_CONTEXT_OPENGL_DEBUG,
                                       EGL_TRUE,
                                       EGL_NONE};
    const EGLContext context =
        eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
    if (context == EGL_NO_CONTEXT) return EGL_NO_CONTEXT;
    if (eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context)) return context;
    eglDestroyContext(display, context);
    return EGL_NO_CONTEXT;
}

/// Displays to try, best first: hardware devices, then Mesa without a surface.
std::vector<EGLDisplay> candidate_displays() {
    std::vector<EGLDisplay> displays;
    const auto get_display =
        egl_function<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    if (get_display == nullptr) return displays;
    const auto query_devices = egl_function<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
    const auto query_string =
        egl_function<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
    if (query_devices != nullptr && query_string != nullptr) {
        std::array<EGLDeviceEXT, 16> devices{};
        EGLint count = 0;
        query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count);
        for (EGLint i = 0; i < count; ++i) {
            const EGLDeviceEXT device = devices[static_cast<std::size_t>(i)];
            if (has_extension(query_string(device, EGL_EXTENSIONS), "EGL_MESA_device_software")) {
                continue;
            }
            displays.push_back(get_display(EGL_PLATFORM_DEVICE_EXT, device, nullptr));
        }
    }
    displays.push_back(get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return displays;
}

std::string_view gl_string(GLenum name) {
    const GLubyte* text = glGetString(name);
    return text != nullptr ? reinterpret_cast<const char*>(text) : "";
}

GlDevice inspect_current_context() {
    GlDevice device{.renderer = std::string(gl_string(GL_RENDERER)),
                    .version = std::string(gl_string(GL_VERSION))};
    if (epoxy_gl_version() < 45) {
        throw Error(ExitCode::kInternal,
                    fmt::format("OpenGL 4.5 is needed and this machine offers \"{}\" on \"{}\": "
                                "update the graphics driver or install Mesa's libgl1-mesa-dri",
                                device.version, device.renderer));
    }
    device.software = runs_on_cpu();
    GLint64 bytes = 0;
    glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &bytes);
    device.max_storage_bytes = bytes;
    glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &device.max_texture_3d);
    return device;
}

void GLAPIENTRY note_message(GLenum, GLenum type, GLuint, GLenum severity, GLsizei length,
                             const GLchar* message, const void* user) {
    const bool wrong = type == GL_DEBUG_TYPE_ERROR || type == GL_DEBUG_TYPE_UNDEFINED_BEHAVIOR ||
                       severity == GL_DEBUG_SEVERITY_HIGH;
    auto& errors = *static_cast<std::vector<std::string>*>(const_cast<void*>(user));
    if (!wrong || errors.size() >= kMaxErrorsKept) return;
    errors.emplace_back(message,
                        length < 0 ? std::strlen(message) : static_cast<std::size_t>(length));
}

void collect_errors(std::vector<std::string>& errors) {
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    glDebugMessageCallback(&note_message, &errors);
}

}  // namespace

bool runs_on_cpu() {
    const std::string_view renderer = gl_string(GL_RENDERER);
    return std::ranges::any_of(
        std::array<std::string_view, 3>{"llvmpipe", "softpipe", "SwiftShader"},
        [&](std::string_view name) { return renderer.find(name) != std::string_view::npos; });
}

Context Context::headless() {
    auto state = std::make_unique<State>();
    for (const EGLDisplay display : candidate_displays()) {
        const EGLContext context = make_current_on(display);
        if (context == EGL_NO_CONTEXT) continue;
        state->display = display;
        state->context = context;
        state->device = inspect_current_context();
        collect_errors(state->errors);
        return Context(std::move(state));
    }
    throw Error(ExitCode::kInternal,
                "no OpenGL 4.5 can be had here without a display: install a graphics driver with "
                "EGL, or Mesa's software renderer (libegl1 and libgl1-mesa-dri)");
}

Context Context::of_window() {
    auto state = std::make_unique<State>();
    state->device = inspect_current_context();
    collect_errors(state->errors);
    return Context(std::move(state));
}

Context::Context(std::unique_ptr<State> state) : state_(std::move(state)) {}
Context::Context(Context&&) noexcept = default;
Context& Context::operator=(Context&&) noexcept = default;
Context::~Context() = default;

const GlDevice& Context::device() const {
    return state_->device;
}
std::span<const std::string> Context::errors() const {
    return state_->errors;
}

}  // namespace glowworm
