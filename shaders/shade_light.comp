#version 450 core
#extension GL_GOOGLE_include_directive : require
#include "frame_layout.h"
#include "view.glsl"

// A pixel's sub-pixels share its samples of an area light: each takes others of the same grid.
layout(location = 3) uniform int sub_pixels;   // along a pixel's edge
vec2 area_phase = vec2(0.5);
#define AREA_SAMPLES ((6 + sub_pixels - 1) / sub_pixels)
#define AREA_PHASE area_phase
bool in_full_view = false;
#define IN_FULL_VIEW in_full_view
#ifdef WET
#include "glossy.glsl"
vec3 surface_normal = vec3(0.0), to_eye = vec3(0.0);
float alpha = 1.0;
float glossy_sum = 0.0;   // of a light's samples: irradiance per intensity or radiance, reflected
#define EACH_SAMPLE(to_light, cosines) \
    glossy_sum += (cosines) * glossy_reflection(surface_normal, to_eye, to_light, alpha)
#endif
#include "direct_light.glsl"

// One light, of an area light some rows of samples, on every pixel's surface: added to what
// shade.comp began with.
layout(local_size_x = 8, local_size_y = 8) in;
layout(std430, binding = BINDING_PIXEL_SURFACES) readonly buffer pixel_surfaces { vec4 surfaces[]; };
layout(std430, binding = BINDING_PIXEL_ALBEDOS) readonly buffer pixel_albedos { vec4 albedos[]; };
layout(std430, binding = BINDING_PIXEL_DIRECT) buffer pixel_direct { vec4 direct[]; };
layout(std430, binding = BINDING_PIXEL_SPECULAR) buffer pixel_specular { vec4 specular[]; };
layout(std430, binding = BINDING_PIXEL_EMISSION) readonly buffer pixel_emission { vec4 emission[]; };
layout(std430, binding = BINDING_PIXEL_BEAUTY) buffer pixel_beauty { vec4 beauty[]; };
layout(location = 0) uniform uint light;
layout(location = 1) uniform int first_row;
layout(location = 2) uniform int last_row;
layout(location = 4) uniform float wetness;   // 0..1

const float kPi = 3.14159265359;
// How much of an area light a pixel sees, by a few rays. Only what is partly seen takes all samples.
const float kHidden = 0.0, kInFullView = 1.0, kPartlySeen = 2.0;
const int kLookRow = -1;   // as first_row: look at the light and keep in direct's w what was seen
// Leaf edges: a pixel lies on the points themselves, nearer to them than a leaf's mean does. More
// lets light under the bumps of a wall that it grazes.
const float kShadowOffset = 0.03;

float look_at(Light area, vec3 position, vec3 normal) {
    const vec2 places[5] = vec2[](vec2(0.5), vec2(0.08), vec2(0.92, 0.08), vec2(0.08, 0.92), vec2(0.92));
    int seen = 0, hidden = 0;
    for (int i = 0; i < 5; ++i) {
        vec3 point = area.position.xyz + places[i].x * area.edge_u.xyz + places[i].y * area.edge_v.xyz;
        vec3 to_lamp = point - position;
        if (dot(normal, to_lamp) <= 0.0 || dot(area.axis.xyz, to_lamp) >= 0.0) continue;
        bool sees = visible_from(position, normal, kShadowOffset * grid.voxel_size, point, area.tag,
                                 area.axis.xyz);
        seen += sees ? 1 : 0;
        hidden += sees ? 0 : 1;
    }
    if (seen + hidden < 5) return kPartlySeen;   // partly below the horizon: too few to tell
    return hidden == 0 ? kInFullView : seen == 0 ? kHidden : kPartlySeen;
}

void main() {
    if (any(greaterThanEqual(gl_GlobalInvocationID.xy, uvec2(view.width, view.height)))) return;
    uint pixel = gl_GlobalInvocationID.y * view.width + gl_GlobalInvocationID.x;
    vec4 surface = surfaces[pixel];
    vec4 albedo = albedos[pixel];
    if (surface.w <= 0.0 || emission[pixel].w > 0.0) return;   // nothing, or a lamp itself
    vec3 origin, ray;
    camera_ray(vec2(gl_GlobalInvocationID.xy) + 0.5, origin, ray);
    vec3 along = octree_from_camera_direction(ray);
    vec3 position = octree_from_camera(origin) + along * surface.w;
    if (first_row == kLookRow) {
        direct[pixel].w = look_at(lights[light], position, surface.xyz);
        return;
    }
    if (lights[light].kind == LIGHT_AREA) {
        if (direct[pixel].w == kHidden) return;
        in_full_view = direct[pixel].w == kInFullView;
    }
    area_phase = (vec2(gl_GlobalInvocationID.xy % uint(sub_pixels)) + 0.5) / float(sub_pixels);

    float dry = 1.0;
#ifdef WET
    to_eye = -normalize(along);
    surface_normal = film_normal(surface.xyz, to_eye);
    alpha = glossy_alpha(albedo.w);
    dry = 1.0 - wetness * film_reflectance(dot(surface_normal, to_eye));
#endif
    vec3 added = albedo.rgb * (dry / kPi) *
                 direct_irradiance_of(light, position, surface.xyz,
                                      kShadowOffset * grid.voxel_size, first_row, last_row);
    direct[pixel].rgb += added;
#ifdef WET
    vec3 mirrored = wetness * glossy_sum * lights[light].intensity.rgb;
    specular[pixel].rgb += mirrored;
    added += mirrored;
#endif
    beauty[pixel].rgb += added;
}
