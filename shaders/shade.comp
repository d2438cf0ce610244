#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"
#include "light_lookup.glsl"
#include "panel.glsl"

// What every pixel's surface emits and reflects again; shade_light.comp adds the lights themselves,
// one by one.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) buffer pixel_albedos { vec4 albedos[]; };
layout(std430, binding = BINDING_PIXEL_DIRECT) writeonly buffer pixel_direct { vec4 direct[]; };
layout(std430, binding = BINDING_PIXEL_INDIRECT) writeonly buffer pixel_indirect { vec4 indirect[]; };
layout(std430, binding = BINDING_PIXEL_SPECULAR) writeonly buffer pixel_specular { vec4 specular[]; };
layout(std430, binding = BINDING_PIXEL_EMISSION) writeonly buffer pixel_emission { vec4 emission[]; };
layout(std430, binding = BINDING_PIXEL_BEAUTY) writeonly buffer pixel_beauty { vec4 beauty[]; };
layout(location = 0) uniform uint panel_count;
layout(location = 1) uniform float wetness;   // 0..1

const float kPi = 3.14159265359;
const float kPanelDepth = 0.5;   // leaf edges: a wall that near in front of a panel is its mounting

#ifdef WET
#include "cone.glsl"
#include "glossy.glsl"

const float kMirrorOffset = 0.25;   // leaf edges: how far a cone starts off the surface

// What a film of water mirrors of the walls round it, W/sr/m2.
vec3 mirrored_radiance(vec3 position, vec3 normal, vec3 to_eye, float ndf_length) {
    Cone cone;
    cone.origin = position + normal * (kMirrorOffset * grid.voxel_size);
    cone.direction = reflect(-to_eye, normal);
    cone.plane_normal = normal;
    cone.spread = 2.0 * glossy_alpha(ndf_length);
    cone.start = grid.voxel_size;
    if (dot(cone.direction, normal) <= 0.0) return vec3(0.0);
    return film_reflectance(dot(normal, to_eye)) * trace_cone(cone, false);
}
#endif

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
    vec3 reflected = vec3(0.0), mirrored = vec3(0.0), emitted = vec3(0.0);
    if (panel >= 0) {
        vec3 normal = normalize(cross(panels[panel].edge_u.xyz, panels[panel].edge_v.xyz));
        bool lit_side = dot(normal, along) < 0.0;
        emitted = lit_side ? panels[panel].radiance.rgb : vec3(0.0);
        surfaces[pixel] = vec4(lit_side ? normal : -normal, panel_depth);
        albedos[pixel] = vec4(0.0, 0.0, 0.0, 1.0);
    } else if (hit) {
        vec3 position = eye + along * surface.w;
        reflected = albedos[pixel].rgb / kPi * indirect_irradiance(position, surface.xyz);
#ifdef WET
        vec3 to_eye = -normalize(along);
        vec3 film = film_normal(surface.xyz, to_eye);
        reflected *= 1.0 - wetness * film_reflectance(dot(film, to_eye));
        mirrored = wetness * mirrored_radiance(position, film, to_eye, albedos[pixel].w);
#endif
    }
    direct[pixel] = vec4(0.0);   // w: what shade_light.comp keeps there
    indirect[pixel] = vec4(reflected, 1.0);
    specular[pixel] = vec4(mirrored, 1.0);
    emission[pixel] = vec4(emitted, panel >= 0 ? 1.0 : 0.0);
    beauty[pixel] = vec4(reflected + mirrored + emitted, hit || panel >= 0 ? 1.0 : 0.0);
}
