#pragma once

#include <epoxy/gl.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "viewer/gpu/objects.h"

namespace glowworm {

/// Shaders from files, linked. `name.comp`, `name.vert` and `name.frag` say their stage by their
/// ending.
class Program {
  public:
    Program() = default;
    /// Reads, compiles and links `entries` from shader_folder(). Throws Error (kInternal) with the
    /// driver's message, its lines given as file:line.
    explicit Program(std::vector<std::string> entries, std::vector<std::string> defines = {});
    Program(Program&&) noexcept = default;
    Program& operator=(Program&&) noexcept = default;
    ~Program();

    void use() const { glUseProgram(name_.get()); }
    GLuint name() const { return name_.get(); }

    /// Runs a compute shader over at least `count` invocations of `group_size` each and makes what
    /// it wrote visible to all that follows. More groups than one axis allows go on in y: the
    /// shader's index is gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x.
    void dispatch(std::size_t count, std::size_t group_size) const;

    /// Compiles again when a file has changed since. On an error the program in use stays and the
    /// message comes back.
    std::optional<std::string> reload_if_changed();

  private:
    std::vector<std::string> entries_, defines_;
    std::vector<std::filesystem::path> files_;
    std::filesystem::file_time_type newest_{};
    GlName name_;
};

/// Uniforms by their explicit location, which every shader of ours gives.
void set_uniform(const Program& program, GLint location, float value);
void set_uniform(const Program& program, GLint location, std::int32_t value);
void set_uniform(const Program& program, GLint location, std::uint32_t value);

}  // namespace glowworm
