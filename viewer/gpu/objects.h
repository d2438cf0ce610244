#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace glowworm {

/// The name of a GL object that this owns: moved, never copied, deleted once.
class GlName {
  public:
    GlName() = default;
    explicit GlName(GLuint name) : name_(name) {}
    GlName(GlName&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
    GlName& operator=(GlName&& other) noexcept {
        std::swap(name_, other.name_);
        return *this;
    }
    GLuint get() const { return name_; }

  private:
    GLuint name_ = 0;
};

/// Memory of the GPU with a fixed size. An empty one is legal and holds 16 bytes of zeros, so that
/// it can be bound. Where OpenGL runs on the CPU, it is memory of the process all the while: there
/// threads other than the one that made it may map, read and write it as well.
class Buffer {
  public:
    Buffer() = default;
    /// `bytes` of zeros.
    Buffer(const std::string& label, std::size_t bytes);
    template <typename T>
    static Buffer of(const std::string& label, std::span<const T> values) {
        Buffer buffer(label, values.size_bytes());
        buffer.write(values);
        return buffer;
    }
    Buffer(Buffer&&) noexcept = default;
    Buffer& operator=(Buffer&&) noexcept = default;
    ~Buffer();

    /// Replaces values from `first` on; what would lie past the end is an internal Error.
    template <typename T>
    void write(std::span<const T> values, std::size_t first = 0) {
        write_bytes(first * sizeof(T), std::as_bytes(values));
    }
    template <typename T>
    void write(const std::vector<T>& values, std::size_t first = 0) {
        write(std::span<const T>(values), first);
    }
    /// `count` values from `first` on. Waits for the GPU.
    template <typename T>
    std::vector<T> read(std::size_t count, std::size_t first = 0) const {
        static_assert(std::is_trivially_copyable_v<T>);
        std::vector<T> values(count);
        read_bytes(first * sizeof(T), std::as_writable_bytes(std::span(values)));
        return values;
    }
    void clear();  ///< all zeros

    /// All of its values where they lie, while it lives. Only where OpenGL runs on the CPU, else an
    /// internal Error. On the thread that made it this waits for what GL has yet to do.
    template <typename T>
    std::span<T> map() const {
        static_assert(std::is_trivially_copyable_v<T>);
        return {static_cast<T*>(map_bytes()), bytes_ / sizeof(T)};
    }

    void bind_storage(GLuint binding) const;
    /// Shows `bytes` from `offset` on; the offset is a multiple of 256.
    void bind_storage(GLuint binding, std::size_t offset, std::size_t bytes) const;
    void bind_uniform(GLuint binding) const;

    GLuint name() const { return name_.get(); }
    std::size_t bytes() const { return bytes_; }

  private:
    void* map_bytes() const;
    void write_bytes(std::size_t offset, std::span<const std::byte> bytes);
    void read_bytes(std::size_t offset, std::span<std::byte> bytes) const;
    GlName name_;
    std::size_t bytes_ = 0;
    void* at_ = nullptr;  // where OpenGL runs on the CPU
    std::thread::id made_by_ = std::this_thread::get_id();
};

/// An image of fixed size and format with one level.
class Texture {
  public:
    Texture() = default;
    /// `format` is a sized one (GL_RGBA32F). Filtered nearest, clamped at the edge.
    Texture(const std::string& label, GLenum format, int width, int height);
    Texture(const std::string& label, GLenum format, int width, int height, int depth);
    Texture(Texture&&) noexcept = default;
    Texture& operator=(Texture&&) noexcept = default;
    ~Texture();

    void bind(GLuint unit) const;
    void bind_image(GLuint unit, GLenum access) const;
    /// Row 0 is the bottom one, as GL has it; `channels` floats a texel. Waits for the GPU.
    std::vector<float> read_floats(GLenum layout, int channels) const;

    GLuint name() const { return name_.get(); }
    GLenum format() const { return format_; }
    int width() const { return width_; }
    int height() const { return height_; }

  private:
    GlName name_;
    GLenum format_ = 0;
    int width_ = 0, height_ = 0, depth_ = 1;
};

/// Where fragments go. The textures stay their owner's and must outlive it.
class Framebuffer {
  public:
    Framebuffer() = default;
    /// Attaches `colors` to locations 0, 1, ...; `depth` may be null. What the driver calls
    /// incomplete is an internal Error.
    Framebuffer(const std::string& label, std::span<const Texture* const> colors,
                const Texture* depth);
    Framebuffer(Framebuffer&&) noexcept = default;
    Framebuffer& operator=(Framebuffer&&) noexcept = default;
    ~Framebuffer();

    void bind() const;  ///< also sets the viewport
    GLuint name() const { return name_.get(); }

  private:
    GlName name_;
    int width_ = 0, height_ = 0;
};

/// The vertex layout that draws without attributes need.
class VertexArray {
  public:
    explicit VertexArray(const std::string& label);
    VertexArray(VertexArray&&) noexcept = default;
    VertexArray& operator=(VertexArray&&) noexcept = default;
    ~VertexArray();
    void bind() const;

  private:
    GlName name_;
};

}  // namespace glowworm
