// What a pixel's surface emits and reflects again. The pass has panel_count, wetness and
// corners.
#include "shade_corners.glsl"
#include "panel.glsl"

CONSTANT float kPanelDepth = 0.5f;   // leaf edges: a wall that near in front of a panel is its mounting

#ifdef WET
#include "cone.glsl"
#include "glossy.glsl"

CONSTANT float kMirrorOffset = 0.25f;   // leaf edges: how far a cone starts off the surface

// What a film of water mirrors of the walls round it, W/sr/m2.
vec3 mirrored_radiance(vec3 position, vec3 normal, vec3 to_eye, float ndf_length) {
    Cone cone;
    cone.origin = position + normal * (kMirrorOffset * grid.voxel_size);
    cone.direction = reflect(-to_eye, normal);
    cone.plane_normal = normal;
    cone.spread = 2.0f * glossy_alpha(ndf_length);
    cone.start = grid.voxel_size;
    if (dot(cone.direction, normal) <= 0.0f) return vec3(0.0f);
    return film_reflectance(dot(normal, to_eye)) * trace_cone(cone, false);
}
#endif

// `irradiance`: reflected at least once, at the pixel.
void shade_surface(Pixel pixel, vec3 irradiance) {
    uint i = pixel.index;
    bool hit = pixel.surface.w > 0.0f;
    float farthest = hit ? pixel.surface.w + kPanelDepth * grid.voxel_size : 1e30f;
    float panel_depth;
    int panel = nearest_panel(panel_count, pixel.eye, pixel.along, farthest, panel_depth);
    vec3 reflected = vec3(0.0f), mirrored = vec3(0.0f), emitted = vec3(0.0f);
    if (panel >= 0) {
        vec3 facing = normalize(cross(vec3(panels[panel].edge_u), vec3(panels[panel].edge_v)));
        bool lit_side = dot(facing, pixel.along) < 0.0f;
        emitted = lit_side ? vec3(panels[panel].radiance) : vec3(0.0f);
        surfaces[i] = vec4(lit_side ? facing : -facing, panel_depth);
        albedos[i] = vec4(0.0f, 0.0f, 0.0f, 1.0f);
    } else if (hit) {
        reflected = vec3(albedos[i]) * kReflects * irradiance;
#ifdef WET
        if (wetness > 0.0f) {
            vec3 to_eye = -normalize(pixel.along), normal = vec3(pixel.surface);
            vec3 film = film_normal(normal, to_eye);
            reflected *= 1.0f - wetness * film_reflectance(dot(film, to_eye));
            mirrored = wetness * mirrored_radiance(pixel.position, film, to_eye, albedos[i].w);
        }
#endif
    }
    direct[i] = vec4(0.0f);
    indirect[i] = vec4(reflected, 1.0f);
    specular[i] = vec4(mirrored, 1.0f);
    emission[i] = vec4(emitted, panel >= 0 ? 1.0f : 0.0f);
    beauty[i] = vec4(reflected + mirrored + emitted, hit || panel >= 0 ? 1.0f : 0.0f);
}
