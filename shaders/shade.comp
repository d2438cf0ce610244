#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"

// A pixel's sub-pixels share its samples of an area light: each takes others of the same grid.
layout(location = 1) uniform int sub_pixels;   // along a pixel's edge
vec2 area_phase = vec2(0.5);
#define AREA_SAMPLES ((6 + sub_pixels - 1) / sub_pixels)
#define AREA_PHASE area_phase
#include "direct_light.glsl"
#include "light_lookup.glsl"
#include "panel.glsl"

// Light on every pixel's surface: each layer by itself, and their sum.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) buffer pixel_albedos { vec4 albedos[]; };
layout(std430, binding = BINDING_PIXEL_DIRECT) writeonly buffer pixel_direct { vec4 direct[]; };
layout(std430, binding = BINDING_PIXEL_INDIRECT) writeonly buffer pixel_indirect { vec4 indirect[]; };
layout(std430, binding = BINDING_PIXEL_EMISSION) writeonly buffer pixel_emission { vec4 emission[]; };
layout(std430, binding = BINDING_PIXEL_BEAUTY) writeonly buffer pixel_beauty { vec4 beauty[]; };
layout(location = 0) uniform uint panel_count;

const float kPi = 3.14159265359;
const float kPanelDepth = 0.5;   // leaf edges: a wall that near in front of a panel is its mounting

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(view.width, view.height)))) return;
    uint pixel = gl_GlobalInvocationID.y * view.width + gl_GlobalInvocationID.x;
    vec3 origin, ray;
    camera_ray(vec2(gl_GlobalInvocationID.xy) + 0.5, origin, ray);
    vec3 eye = octree_from_camera(origin), along = octree_from_camera_direction(ray);

    vec4 surface = surfaces[pixel];
    bool hit = surface.w > 0.0;
    float panel_depth;
    int panel = nearest_panel(panel_count, eye, along,
                              hit ? surface.w + kPanelDepth * grid.voxel_size : 1e30, panel_depth);
    vec3 from_lights = vec3(0.0), reflected = vec3(0.0), emitted = vec3(0.0);
    if (panel >= 0) {
        vec3 normal = normalize(cross(panels[panel].edge_u.xyz, panels[panel].edge_v.xyz));
        bool lit_side = dot(normal, along) < 0.0;
        emitted = lit_side ? panels[panel].radiance.rgb : vec3(0.0);
        surfaces[pixel] = vec4(lit_side ? normal : -normal, panel_depth);
        albedos[pixel] = vec4(0.0, 0.0, 0.0, 1.0);
    } else if (hit) {
        area_phase = (vec2(gl_GlobalInvocationID.xy % uint(sub_pixels)) + 0.5) / float(sub_pixels);
        vec3 position = eye + along * surface.w;
        vec3 brdf = albedos[pixel].rgb / kPi;
        from_lights = brdf * direct_irradiance(position, surface.xyz);
        reflected = brdf * indirect_irradiance(position, surface.xyz);
    }
    direct[pixel] = vec4(from_lights, 1.0);
    indirect[pixel] = vec4(reflected, 1.0);
    emission[pixel] = vec4(emitted, 1.0);
    beauty[pixel] = vec4(from_lights + reflected + emitted, hit || panel >= 0 ? 1.0 : 0.0);
}
