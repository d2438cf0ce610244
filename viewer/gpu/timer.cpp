#include "viewer/gpu/timer.h"

#include <chrono>

namespace glowworm {

namespace {

double now_ms() {
    return std::chrono::duration<double, std::milli>(
               std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

PassTimer::PassTimer(const GlDevice& device) : software_(device.software) {
    GLuint name = 0;
    glCreateQueries(GL_TIME_ELAPSED, 1, &name);
    query_ = GlName(name);
}

PassTimer::~PassTimer() {
    const GLuint name = query_.get();
    if (name != 0) glDeleteQueries(1, &name);
}

void PassTimer::begin() {
    glFinish();
    begun_at_ms_ = now_ms();
    glBeginQuery(GL_TIME_ELAPSED, query_.get());
}

void PassTimer::end(const std::string& name) {
    const double given_ms = now_ms() - begun_at_ms_;
    glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    const double finished_ms = now_ms() - begun_at_ms_;
    GLuint64 elapsed_ns = 0;
    glGetQueryObjectui64v(query_.get(), GL_QUERY_RESULT, &elapsed_ns);
    const double query_ms = static_cast<double>(elapsed_ns) * 1e-6;
    samples_[name].push_back({software_ ? finished_ms : query_ms, given_ms});
}

}  // namespace glowworm
