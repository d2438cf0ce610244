#version 450
#extension GL_GOOGLE_include_directive : require
// Inner products of residuals for Anderson's least squares, one partial sum per group; the CPU adds
// the groups in order, in double.
#include "octree.glsl"

layout(local_size_x = 64) in;
layout(location = 0) uniform uint history;   // earlier iterates, 0..3
layout(std430, binding = BINDING_INDIRECT) readonly buffer Indirect { vec4 indirect_field[]; };  // x
layout(std430, binding = BINDING_SCRATCH_B) readonly buffer Gathered { vec4 gathered[]; };       // T(x)
// Luminance of the residual T(x) - x of the iterate in slot s at [s * count + lobe]; `slots`
// lists the newest first.
layout(std430, binding = BINDING_SCRATCH_C) buffer Residuals { float residuals[]; };
layout(location = 1) uniform uint slots[4];
layout(location = 5) uniform uint count;   // of what the iterates are made of
// Per group: 6 products of differences (00 01 02 11 12 22), 3 with the newest residual, |r|^2, |x|^2,
// the sum of relative changes.
layout(std430, binding = BINDING_SCRATCH_A) writeonly buffer Sums { float sums[]; };

const uint kSums = 12u;
shared float partial[kSums][64];

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    uint local = gl_LocalInvocationID.x;
    uint i = group * 64u + local;
    bool here = i < count;
    float x = here ? luminance(indirect_field[i].rgb) : 0.0;
    float r = here ? luminance(gathered[i].rgb) - x : 0.0;
    if (here) residuals[slots[0] * count + i] = r;
    float d[3];
    for (uint j = 0u; j < 3u; ++j) {
        d[j] = here && j < history ? r - residuals[slots[j + 1u] * count + i] : 0.0;
    }
    partial[0][local] = d[0] * d[0];
    partial[1][local] = d[0] * d[1];
    partial[2][local] = d[0] * d[2];
    partial[3][local] = d[1] * d[1];
    partial[4][local] = d[1] * d[2];
    partial[5][local] = d[2] * d[2];
    partial[6][local] = d[0] * r;
    partial[7][local] = d[1] * r;
    partial[8][local] = d[2] * r;
    partial[9][local] = r * r;
    partial[10][local] = x * x;
    partial[11][local] = abs(r) > 0.0 ? abs(r) / max(x, abs(r)) : 0.0;
    for (uint half_size = 32u; half_size > 0u; half_size >>= 1) {
        barrier();
        if (local < half_size) {
            for (uint s = 0u; s < kSums; ++s) partial[s][local] += partial[s][local + half_size];
        }
    }
    barrier();
    if (local < kSums && group * 64u < count) {
        sums[group * kSums + local] = partial[local][0];
    }
}
