#ifndef DIRECT_LIGHT_GLSL
#define DIRECT_LIGHT_GLSL
// Irradiance straight from the lights at a surface point, W/m2, with exact shadows.
#include "trace.glsl"

#ifndef AREA_SAMPLES
#define AREA_SAMPLES AREA_SAMPLES_OF_SURFACE   // per side of an area light's rectangle
#endif
#ifndef AREA_PHASE
#define AREA_PHASE 0.5f   // where in its cell of the rectangle a sample lies, 0..1 along both edges
#endif

#ifndef IN_FULL_VIEW
#define IN_FULL_VIEW false   // whether all of a light is known to be seen
#endif
#ifndef EACH_SAMPLE
#define EACH_SAMPLE(to_light, irradiance)   // what a pass makes of a sample seen, by unit intensity
#endif

#ifndef __cplusplus
layout(std430, binding = BINDING_LIGHTS) readonly buffer Lights { Light lights[]; };
#endif

// A lamp's in its group.
uint lamp_bit(uint lamp) { return 1u << (lamp % LAMPS_IN_GROUP); }

// Blender's spot: I cos(theta) smoothstep over the outer part of the cone. 1 on the axis.
ANY_FLOAT spot_falloff(ANY_FLOAT cosine, float cosine_edge, float blend) {
    ANY_FLOAT t = (cosine - cosine_edge) / max((1.0f - cosine_edge) * blend, 1e-6f);
    t = min(max(t, 0.0f), 1.0f);
    return max(cosine, 0.0f) * t * t * (3.0f - 2.0f * t);
}

// Irradiance by unit intensity, 1/m2, from a lamp without extent at a surface point that sees it.
ANY_FLOAT share_of_lamp(Light light, ANY_VEC3 position, ANY_VEC3 normal) {
    ANY_VEC3 to_lamp = vec3(light.position) - position;
    ANY_FLOAT per_metre = inversesqrt(max(dot(to_lamp, to_lamp), 1e-12f));
    ANY_FLOAT share = max(dot(normal, to_lamp), 0.0f) * per_metre * (per_metre * per_metre);
    if (light.kind == LIGHT_SPOT) {
        share *= spot_falloff(-dot(to_lamp, vec3(light.axis)) * per_metre, light.axis.w,
                              light.edge_u.w);
    }
    return share;
}

vec3 irradiance_from_lamp(Light light, vec3 position, vec3 normal, float offset) {
    float share = share_of_lamp(light, position, normal);
    if (share <= 0.0f) return vec3(0.0f);
    if (!IN_FULL_VIEW &&
        !visible_from(position, normal, offset, vec3(light.position), 0u, vec3(0.0f))) {
        return vec3(0.0f);
    }
    EACH_SAMPLE(normalize(vec3(light.position) - position), share);
    return vec3(light.intensity) * share;
}

// Of its AREA_SAMPLES rows of samples, those from first_row to before last_row.
vec3 irradiance_from_area(Light light, vec3 position, vec3 normal, float offset, int first_row,
                          int last_row) {
    float area = length(cross(vec3(light.edge_u), vec3(light.edge_v)));
    float area_of_sample = area / float(AREA_SAMPLES * AREA_SAMPLES);
    float sum = 0.0f;
    for (int v = first_row; v < last_row; ++v) {
        for (int u = 0; u < AREA_SAMPLES; ++u) {
            vec2 at = (vec2(u, v) + AREA_PHASE) / float(AREA_SAMPLES);
            vec3 point =
                vec3(light.position) + at.x * vec3(light.edge_u) + at.y * vec3(light.edge_v);
            vec3 to_lamp = point - position;
            float squared = max(dot(to_lamp, to_lamp), 1e-12f);
            float cosines = dot(normal, to_lamp) * -dot(vec3(light.axis), to_lamp) / squared;
            if (dot(normal, to_lamp) <= 0.0f || cosines <= 0.0f) continue;
            if (IN_FULL_VIEW ||
                visible_from(position, normal, offset, point, light.tag, vec3(light.axis))) {
                EACH_SAMPLE(to_lamp * inversesqrt(squared), cosines / squared * area_of_sample);
                sum += cosines / squared;
            }
        }
    }
    return vec3(light.intensity) * (sum * area_of_sample);
}

// From one light, of an area light the given rows of samples. Passes that may have many lights take
// one of them a dispatch: llvmpipe ends loops silently after 65535 turns of an invocation, all its
// loops together, and a shadow ray takes some hundred.
vec3 direct_irradiance_of(uint light, vec3 position, vec3 normal, float offset, int first_row,
                          int last_row) {
    if (lights[light].kind == LIGHT_AREA) {
        return irradiance_from_area(lights[light], position, normal, offset, first_row, last_row);
    }
    return first_row == 0 ? irradiance_from_lamp(lights[light], position, normal, offset)
                          : vec3(0.0f);
}

// From one light on a lobe's plane.
vec3 direct_irradiance_of_lobe(uint light, uint lobe) {
    float offset = max(kLeastOffset * grid.voxel_size, kSigmasOff * lobes[lobe].plane_sigma);
    return direct_irradiance_of(light, lobe_position(lobe), lobe_normal(lobe), offset, 0,
                                AREA_SAMPLES);
}

// `offset`: how far shadow rays start off the surface, m.
vec3 direct_irradiance(vec3 position, vec3 normal, float offset) {
    vec3 sum = vec3(0.0f);
    for (uint i = 0u; i < grid.light_count; ++i) {
        sum += direct_irradiance_of(i, position, normal, offset, 0, AREA_SAMPLES);
    }
    return sum;
}

vec3 direct_irradiance(vec3 position, vec3 normal) {
    return direct_irradiance(position, normal, kPointOffset * grid.voxel_size);
}
#endif
