#include "viewer/gpu/objects.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "octree/error.h"
#include "viewer/gpu/context.h"

namespace glowworm {

namespace {

constexpr std::size_t kEmptyBufferBytes = 16;

void label_object(GLenum kind, GLuint name, const std::string& label) {
    glObjectLabel(kind, name, static_cast<GLsizei>(label.size()), label.data());
}

GLuint create_texture(const std::string& label, GLenum target) {
    GLuint name = 0;
    glCreateTextures(target, 1, &name);
    label_object(GL_TEXTURE, name, label);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER}) {
        glTextureParameteri(name, filter, GL_NEAREST);
    }
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R}) {
        glTextureParameteri(name, wrap, GL_CLAMP_TO_EDGE);
    }
    return name;
}

}  // namespace

Buffer::Buffer(const std::string& label, std::size_t bytes) : bytes_(bytes) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    name_ = GlName(name);
    label_object(GL_BUFFER, name, label);
    constexpr GLbitfield kMapped =
        GL_MAP_READ_BIT | GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
    const bool on_cpu = runs_on_cpu();
    const auto size = static_cast<GLsizeiptr>(std::max(bytes, kEmptyBufferBytes));
    glNamedBufferStorage(name, size, nullptr, GL_DYNAMIC_STORAGE_BIT | (on_cpu ? kMapped : 0));
    GLint64 given = 0;
    glGetNamedBufferParameteri64v(name, GL_BUFFER_SIZE, &given);
    if (given < static_cast<GLint64>(bytes)) {
        throw Error(
            ExitCode::kBudget,
            fmt::format("the GPU has no memory for \"{}\" ({:.1f} MiB): simulate light at a "
                        "coarser level with --light-depth",
                        label, static_cast<double>(bytes) / (1 << 20)));
    }
    clear();
    if (!on_cpu) return;
    at_ = glMapNamedBufferRange(name, 0, size, kMapped);
    if (at_ == nullptr) throw Error(ExitCode::kInternal, "a GPU buffer that cannot be mapped");
}

Buffer::~Buffer() {
    const GLuint name = name_.get();
    if (name != 0) glDeleteBuffers(1, &name);
}

void Buffer::clear() {
    const std::uint32_t zero = 0;
    glClearNamedBufferData(name_.get(), GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &zero);
}

void Buffer::write_bytes(std::size_t offset, std::span<const std::byte> bytes) {
    if (offset > bytes_ || bytes.size() > bytes_ - offset) {
        throw Error(ExitCode::kInternal, "a write past the end of a GPU buffer");
    }
    if (bytes.empty()) return;
    if (at_ != nullptr) {
        std::memcpy(static_cast<std::byte*>(map_bytes()) + offset, bytes.data(), bytes.size());
        return;
    }
    glNamedBufferSubData(name_.get(), static_cast<GLintptr>(offset),
                         static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void Buffer::read_bytes(std::size_t offset, std::span<std::byte> bytes) const {
    if (offset > bytes_ || bytes.size() > bytes_ - offset) {
        throw Error(ExitCode::kInternal, "a read past the end of a GPU buffer");
    }
    if (bytes.empty()) return;
    if (at_ != nullptr) {
        std::memcpy(bytes.data(), static_cast<const std::byte*>(map_bytes()) + offset,
                    bytes.size());
        return;
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(name_.get(), static_cast<GLintptr>(offset),
                            static_cast<GLsizeiptr>(bytes.size()), bytes.data());
}

void* Buffer::map_bytes() const {
    if (name_.get() == 0) return nullptr;
    if (at_ == nullptr) throw Error(ExitCode::kInternal, "a GPU buffer that cannot be mapped");
    if (std::this_thread::get_id() == made_by_) {
        glMemoryBarrier(GL_CLIENT_MAPPED_BUFFER_BARRIER_BIT);
        glFinish();
    }
    return at_;
}

void Buffer::bind_storage(GLuint binding) const {
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_.get());
}

void Buffer::bind_storage(GLuint binding, std::size_t offset, std::size_t bytes) const {
    glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, name_.get(), static_cast<GLintptr>(offset),
                      static_cast<GLsizeiptr>(bytes));
}

void Buffer::bind_uniform(GLuint binding) const {
    glBindBufferBase(GL_UNIFORM_BUFFER, binding, name_.get());
}

Texture::Texture(const std::string& label, GLenum format, int width, int height)
    : name_(create_texture(label, GL_TEXTURE_2D)), format_(format), width_(width), height_(height) {
    glTextureStorage2D(name_.get(), 1, format, width, height);
}

Texture::Texture(const std::string& label, GLenum format, int width, int height, int depth)
    : name_(create_texture(label, GL_TEXTURE_3D)),
      format_(format),
      width_(width),
      height_(height),
      depth_(depth) {
    glTextureStorage3D(name_.get(), 1, format, width, height, depth);
}

Texture::~Texture() {
    const GLuint name = name_.get();
    if (name != 0) glDeleteTextures(1, &name);
}

void Texture::bind(GLuint unit) const {
    glBindTextureUnit(unit, name_.get());
}

void Texture::bind_image(GLuint unit, GLenum access) const {
    glBindImageTexture(unit, name_.get(), 0, GL_TRUE, 0, access, format_);
}

std::vector<float> Texture::read_floats(GLenum layout, int channels) const {
    std::vector<float> texels(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) *
                              static_cast<std::size_t>(depth_) *
                              static_cast<std::size_t>(channels));
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glPixelStorei(GL_PACK_ALIGNMENT, 4);
    glGetTextureImage(name_.get(), 0, layout, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(float)), texels.data());
    return texels;
}

Framebuffer::Framebuffer(const std::string& label, std::span<const Texture* const> colors,
                         const Texture* depth) {
    GLuint name = 0;
    glCreateFramebuffers(1, &name);
    name_ = GlName(name);
    label_object(GL_FRAMEBUFFER, name, label);
    std::vector<GLenum> draw_buffers;
    for (const Texture* color : colors) {
        const GLenum attachment = GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(draw_buffers.size());
        glNamedFramebufferTexture(name, attachment, color->name(), 0);
        draw_buffers.push_back(attachment);
        width_ = color->width();
        height_ = color->height();
    }
    glNamedFramebufferDrawBuffers(name, static_cast<GLsizei>(draw_buffers.size()),
                                  draw_buffers.data());
    if (depth != nullptr) {
        glNamedFramebufferTexture(name, GL_DEPTH_ATTACHMENT, depth->name(), 0);
        width_ = depth->width();
        height_ = depth->height();
    }
    if (glCheckNamedFramebufferStatus(name, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
        throw Error(ExitCode::kInternal,
                    fmt::format("the framebuffer \"{}\" is incomplete", label));
    }
}

Framebuffer::~Framebuffer() {
    const GLuint name = name_.get();
    if (name != 0) glDeleteFramebuffers(1, &name);
}

void Framebuffer::bind() const {
    glBindFramebuffer(GL_FRAMEBUFFER, name_.get());
    glViewport(0, 0, width_, height_);
}

VertexArray::VertexArray(const std::string& label) {
    GLuint name = 0;
    glCreateVertexArrays(1, &name);
    name_ = GlName(name);
    label_object(GL_VERTEX_ARRAY, name, label);
}

VertexArray::~VertexArray() {
    const GLuint name = name_.get();
    if (name != 0) glDeleteVertexArrays(1, &name);
}

void VertexArray::bind() const {
    glBindVertexArray(name_.get());
}

}  // namespace glowworm
