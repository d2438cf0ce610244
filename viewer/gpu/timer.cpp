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

PassTimer::PassTimer() {
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
    glEndQuery(GL_TIME_ELAPSED);
    glFinish();
    GLuint64 elapsed_ns = 0;
    glGetQueryObjectui64v(query_.get(), GL_QUERY_RESULT, &elapsed_ns);
    samples_[name].push_back({static_cast<double>(elapsed_ns) * 1e-6, now_ms() - begun_at_ms_});
}

}  // namespace glowworm
