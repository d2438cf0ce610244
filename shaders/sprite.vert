#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "surfel.glsl"

// Every surfel as a sprite that holds its sphere: how the 2016 paper draws (3.3), for comparison.
layout(std430, binding = BINDING_SURFELS) readonly buffer surfel_page { PackedSurfel surfels[]; };
layout(location = 0) uniform vec4 box;     // of the chunk
layout(location = 1) uniform float scale;  // drawn radius over stored radius
layout(location = 0) flat out vec4 sphere;   // camera space, m; w: radius
layout(location = 1) flat out vec3 normal;
layout(location = 2) flat out vec4 albedo;   // w: NDF length

void main() {
    PackedSurfel surfel = surfels[gl_VertexID];
    vec3 centre = camera_from_octree(surfel_position(surfel, box));
    sphere = vec4(centre, surfel_radius(surfel) * scale);
    normal = surfel_normal(surfel);
    albedo = vec4(surfel_albedo(surfel), surfel_ndf_length(surfel));
    vec2 place = pixel_of(centre) / vec2(view.width, view.height) * 2.0 - 1.0;
    gl_Position = centre.z > 0.0 ? vec4(place * centre.z, 0.0, centre.z) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = max(2.0 * sphere.w * pixels_per_metre(max(centre.z, 1e-3)), 1.0);
}
