#pragma once

#include "octree/vec3.h"
#include "shaders/gpu_layout.h"

namespace glowworm {

inline Vec3f to_vec3(const gpu::vec4& v) {
    return {v.x, v.y, v.z};
}

}  // namespace glowworm
