#pragma once

// GLSL's words in C++, for passes whose topics (shaders/*.glsl) are compiled as C++ too: where
// OpenGL runs on the CPU, compiled code is many times faster than the driver's shaders. A pass is a
// struct in this namespace, in a .cpp of its own, whose members are what the shader binds, under
// the same names, and then the topics, whose functions become its members:
//
//     namespace glowworm::gpu {
//     struct InjectPass {
//         std::span<const Node> nodes;
//         std::span<const Lobe> lobes;
//         LightGrid grid;
//     #include "shaders/trace.glsl"
//     };
//     }
//
// A topic that is compiled so keeps to what both languages have: literals end in f, vec3(v) instead
// of v.xyz, CONSTANT, OUT() and INOUT() of gpu_layout.h, bindings within #ifndef __cplusplus. What
// it keeps in globals is a member here, so every thread works on a copy of the pass.

#include <bit>
#include <cmath>
#include <glm/common.hpp>
#include <glm/exponential.hpp>
#include <glm/geometric.hpp>
#include <glm/packing.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <span>

#include "octree/node_layout.h"
#include "octree/vec3.h"
#include "shaders/frame_layout.h"
#include "shaders/gpu_layout.h"

namespace glowworm::gpu {

using glm::bvec3;
using glm::ivec2;
using glm::ivec3;
using glm::ivec4;
using glm::uvec2;
using glm::uvec3;
using glm::uvec4;
using glm::vec2;
using glm::vec3;

using glm::abs;
using glm::all;
using glm::any;
using glm::ceil;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::equal;
using glm::exp;
using glm::exp2;
using glm::floor;
using glm::fract;
using glm::greaterThan;
using glm::greaterThanEqual;
using glm::inversesqrt;
using glm::length;
using glm::lessThan;
using glm::lessThanEqual;
using glm::log;
using glm::log2;
using glm::max;
using glm::min;
using glm::mix;
using glm::normalize;
using glm::pow;
using glm::reflect;
using glm::sign;
using glm::smoothstep;
using glm::sqrt;
using glm::step;
using glm::unpackHalf2x16;
using glm::unpackSnorm2x16;

#pragma GCC diagnostic ignored "-Wshadow"  // of a pass's members by a topic's arguments

inline vec3 vec3_of(const Vec3f& v) {
    return {v.x, v.y, v.z};
}

/// std::popcount is a call where the processor is any x86-64.
inline int bitCount(uint bits) {
    bits -= (bits >> 1) & 0x55555555u;
    bits = (bits & 0x33333333u) + ((bits >> 2) & 0x33333333u);
    return static_cast<int>((((bits + (bits >> 4)) & 0x0f0f0f0fu) * 0x01010101u) >> 24);
}

/// -1 for none.
inline int findMSB(uint bits) {
    return static_cast<int>(std::bit_width(bits)) - 1;
}

}  // namespace glowworm::gpu
