#pragma once

#include "viewer/gpu/timer.h"

namespace glowworm {

/// Runs `pass`, under `name` where somebody measures.
template <typename Pass>
void timed(PassTimer* timer, const char* name, Pass&& pass) {
    if (timer != nullptr) {
        timer->measure(name, pass);
    } else {
        pass();
    }
}

}  // namespace glowworm
