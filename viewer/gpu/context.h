#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace glowworm {

/// What the current OpenGL context runs on.
struct GlDevice {
    std::string renderer;                ///< GL_RENDERER
    std::string version;                 ///< GL_VERSION
    bool software = false;               ///< a CPU renderer (llvmpipe, softpipe, SwiftShader)
    std::int64_t max_storage_bytes = 0;  ///< largest range one shader storage binding may show
    int max_texture_3d = 0;              ///< texels along an edge
};

/// Whether the OpenGL that is current on this thread is a CPU renderer. Its buffers are then memory
/// like any other, and compiled code does in it what shaders do, many times faster.
bool runs_on_cpu();

/// An OpenGL 4.5 core context that is current on this thread, and the errors it reports.
class Context {
  public:
    /// A context without display or surface (EGL): a hardware device where there is one, else
    /// Mesa's software renderer. Throws Error (kInternal) where no OpenGL 4.5 can be had.
    static Context headless();

    /// Takes note of the context that a window has already made current; the window keeps it.
    /// Throws Error (kInternal) where it is older than OpenGL 4.5.
    static Context of_window();

    Context(Context&&) noexcept;
    Context& operator=(Context&&) noexcept;
    ~Context();

    const GlDevice& device() const;

    /// Errors and undefined behaviour that the driver reported so far, oldest first.
    std::span<const std::string> errors() const;

  private:
    struct State;
    explicit Context(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace glowworm
