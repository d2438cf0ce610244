#include "viewer/gpu/program.h"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "octree/error.h"
#include "viewer/gpu/shader_source.h"

namespace glowworm {

namespace {

constexpr std::size_t kMaxGroupsPerAxis = 65535;  // the least that OpenGL 4.5 guarantees

GLenum stage_of(const std::string& entry) {
    if (entry.ends_with(".comp")) return GL_COMPUTE_SHADER;
    if (entry.ends_with(".vert")) return GL_VERTEX_SHADER;
    if (entry.ends_with(".frag")) return GL_FRAGMENT_SHADER;
    throw Error(ExitCode::kInternal, entry + " does not end in .comp, .vert or .frag");
}

std::string log_of(GLuint shader) {
    GLint length = 0;
    glGetShaderiv(shader, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetShaderInfoLog(shader, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    return log;
}

GLuint compile(const ShaderSource& source, const std::string& entry) {
    const GLuint shader = glCreateShader(stage_of(entry));
    const GLchar* text = source.text.c_str();
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    GLint compiled = GL_FALSE;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (compiled == GL_TRUE) return shader;
    const std::string log = source.explain(log_of(shader));
    glDeleteShader(shader);
    throw Error(ExitCode::kInternal, fmt::format("{} does not compile: {}", entry, log));
}

std::string link_log_of(GLuint program) {
    GLint length = 0;
    glGetProgramiv(program, GL_INFO_LOG_LENGTH, &length);
    std::string log(static_cast<std::size_t>(std::max(length, 1)), '\0');
    glGetProgramInfoLog(program, length, &length, log.data());
    log.resize(static_cast<std::size_t>(std::max(length, 0)));
    return log;
}

std::filesystem::file_time_type newest_change(const std::vector<std::filesystem::path>& files) {
    auto newest = std::filesystem::file_time_type::min();
    std::error_code ignored;
    for (const auto& file : files) {
        newest = std::max(newest, std::filesystem::last_write_time(file, ignored));
    }
    return newest;
}

}  // namespace

Program::Program(std::vector<std::string> entries, std::vector<std::string> defines)
    : entries_(std::move(entries)), defines_(std::move(defines)) {
    const std::filesystem::path folder = shader_folder();
    const GLuint program = glCreateProgram();
    name_ = GlName(program);
    std::string label;
    for (const std::string& entry : entries_) {
        ShaderSource source = read_shader(folder, entry, defines_);
        const GLuint shader = compile(source, entry);
        glAttachShader(program, shader);
        glDeleteShader(shader);  // lives on while attached
        std::ranges::move(source.files, std::back_inserter(files_));
        label += label.empty() ? entry : " + " + entry;
    }
    glLinkProgram(program);
    GLint linked = GL_FALSE;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (linked != GL_TRUE) {
        throw Error(ExitCode::kInternal,
                    fmt::format("{} does not link: {}", label, link_log_of(program)));
    }
    glObjectLabel(GL_PROGRAM, program, static_cast<GLsizei>(label.size()), label.data());
    newest_ = newest_change(files_);
}

Program::~Program() {
    const GLuint name = name_.get();
    if (name != 0) glDeleteProgram(name);
}

void Program::dispatch(std::size_t count, std::size_t group_size) const {
    const std::size_t groups = (count + group_size - 1) / group_size;
    if (groups == 0) return;
    const std::size_t rows = (groups + kMaxGroupsPerAxis - 1) / kMaxGroupsPerAxis;
    use();
    glDispatchCompute(static_cast<GLuint>((groups + rows - 1) / rows), static_cast<GLuint>(rows),
                      1);
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

std::optional<std::string> Program::reload_if_changed() {
    const auto newest = newest_change(files_);
    if (newest <= newest_) return std::nullopt;
    newest_ = newest;
    try {
        *this = Program(entries_, defines_);
        return std::nullopt;
    } catch (const Error& error) {
        return error.what();
    }
}

void set_uniform(const Program& program, GLint location, float value) {
    glProgramUniform1f(program.name(), location, value);
}
void set_uniform(const Program& program, GLint location, std::int32_t value) {
    glProgramUniform1i(program.name(), location, value);
}
void set_uniform(const Program& program, GLint location, std::uint32_t value) {
    glProgramUniform1ui(program.name(), location, value);
}

}  // namespace glowworm
