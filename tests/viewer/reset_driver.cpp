// Loaded before the viewer's own libraries, this is a graphics driver that is reset whenever a file
// called "reset" lies in the current folder: software renderers never are.
#include <dlfcn.h>
#include <epoxy/gl.h>
#include <unistd.h>

namespace {

GLenum reset_status() {
    return ::unlink("reset") == 0 ? GL_UNKNOWN_CONTEXT_RESET : GL_NO_ERROR;
}

__attribute__((constructor)) void take_its_place() {
    using Function = GLenum (*)();
    auto* const function =
        static_cast<Function*>(::dlsym(RTLD_DEFAULT, "epoxy_glGetGraphicsResetStatus"));
    if (function != nullptr) *function = &reset_status;
}

}  // namespace
