#version 450 core
// The sphere inside a sprite, with its own depth.
layout(location = 0) flat in vec4 sphere;
layout(location = 1) flat in vec3 normal;
layout(location = 2) flat in vec4 albedo;
layout(location = 0) out vec4 out_normal;
layout(location = 1) out vec4 out_albedo;
layout(location = 2) out float out_depth;

void main() {
    vec2 at = gl_PointCoord * 2.0 - 1.0;
    float height = 1.0 - dot(at, at);
    if (height < 0.0) discard;
    float depth = max(sphere.z - sphere.w * sqrt(height), 1e-3);
    gl_FragDepth = 1.0 - 1e-3 / depth;
    out_normal = vec4(normal, 0.0);
    out_albedo = albedo;
    out_depth = depth;
}
