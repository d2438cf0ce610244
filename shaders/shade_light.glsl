// One light on a pixel's surface, added to what shade_surface.glsl began with. The pass has light,
// sub_pixels and wetness, and in pixel_lamps what is known of the light's group
// (shade_corners.glsl).
#include "shade_pixel.glsl"

// A pixel's sub-pixels share its samples of an area light: each takes others of the same grid.
#define AREA_SAMPLES ((AREA_SAMPLES_OF_SURFACE + sub_pixels - 1) / sub_pixels)
#define AREA_PHASE area_phase
vec2 area_phase = vec2(0.5f);
#define IN_FULL_VIEW in_full_view
bool in_full_view = false;
#ifdef WET
#include "glossy.glsl"
vec3 surface_normal = vec3(0.0f), to_eye = vec3(0.0f);
float alpha = 1.0f;
float glossy_sum = 0.0f;   // of a light's samples: irradiance per intensity or radiance, reflected
#define EACH_SAMPLE(to_light, cosines) \
    glossy_sum += (cosines) * glossy_reflection(surface_normal, to_eye, to_light, alpha)
#endif
#include "direct_light.glsl"

// How much of a light a pixel sees. Only of what is partly seen, or not known, are samples looked at.
CONSTANT float kHidden = 0.0f, kInFullView = 1.0f, kPartlySeen = 2.0f;

// Not where there is no surface, or a lamp itself.
bool can_be_lit(Pixel pixel) {
    return pixel.surface.w > 0.0f && emission[pixel.index].w <= 0.0f;
}

// Cosine to a lamp without extent: where light grazes more than this, bumps smaller than a leaf have
// shadows.
CONSTANT float kGrazing = 0.2f;

// How much of the light the lobes round a pixel agree that it sees.
float known_from_lobes(Pixel pixel) {
    vec3 to_lamp = vec3(lights[light].position) - pixel.position;
    if (lights[light].kind != LIGHT_AREA &&
        dot(vec3(pixel.surface), to_lamp) < kGrazing * length(to_lamp)) {
        return kPartlySeen;
    }
    uvec2 lamps = pixel_lamps[pixel.index];
    return (lamps.x & lamp_bit(light)) != 0u   ? kInFullView
           : (lamps.y & lamp_bit(light)) != 0u ? kHidden
                                               : kPartlySeen;
}

// A tile of 4 x 4 pixels looks at an area light together: each pixel at 3 of a grid of 6 x 6 samples,
// each sample seen by one pixel at least. Nothing that hides a sample from them all is missed,
// however thin; where they do not agree, or lie on different surfaces, the light is partly seen. For
// pixels that the lobes have looked for, these looks count.
CONSTANT uint kGrid = 6u, kLooks = 3u, kTile = 4u, kTilePixels = 16u;

// The looks of the pixel at `place` in its tile, whose first pixel is on the surface `first`: how many
// samples it sees and does not see.
void look(Pixel pixel, uint place, vec4 first, OUT(uint) seen, OUT(uint) hidden) {
    seen = 0u;
    hidden = 0u;
    vec3 normal = vec3(pixel.surface);
    if (dot(normal, vec3(first)) <= 0.9f || abs(pixel.surface.w - first.w) >= 0.05f * first.w) return;
    float known = known_from_lobes(pixel);
    if (known != kPartlySeen) {
        seen = known == kInFullView ? kLooks : 0u;
        hidden = kLooks - seen;
        return;
    }
    Light area = lights[light];
    for (uint i = place; i < kLooks * kTilePixels; i += kTilePixels) {
        uint cell = i % (kGrid * kGrid);
        vec2 on_area = (vec2(cell % kGrid, cell / kGrid) + 0.5f) / float(kGrid);
        vec3 point = vec3(area.position) + on_area.x * vec3(area.edge_u) +
                     on_area.y * vec3(area.edge_v);
        vec3 to_lamp = point - pixel.position;
        // Below the horizon counts as neither: the light is cut by it.
        if (dot(normal, to_lamp) <= 0.0f || dot(vec3(area.axis), to_lamp) >= 0.0f) continue;
        if (visible_from(pixel.position, normal, kPointOffset * grid.voxel_size, point, area.tag,
                         vec3(area.axis))) {
            ++seen;
        } else {
            ++hidden;
        }
    }
}

// Of a tile whose pixels' looks see and do not see so many samples.
float how_much_seen(uint seen, uint hidden) {
    return seen == kLooks * kTilePixels     ? kInFullView
           : hidden == kLooks * kTilePixels ? kHidden
                                            : kPartlySeen;
}

// Adds the light, of an area light the given rows of samples; what is seen of it is in direct's w.
void shade_light(uvec2 at, int first_row, int last_row) {
    Pixel pixel = pixel_at(at);
    uint index = pixel.index;
    if (!can_be_lit(pixel)) return;
    float known = known_from_lobes(pixel);
    if (known == kPartlySeen && lights[light].kind == LIGHT_AREA) known = direct[index].w;
    if (known == kHidden) return;
    in_full_view = known == kInFullView;
    area_phase = (vec2(at.x % uint(sub_pixels), at.y % uint(sub_pixels)) + 0.5f) / float(sub_pixels);

    vec4 albedo = albedos[index];
    vec3 normal = vec3(pixel.surface);
    float dry = 1.0f;
#ifdef WET
    to_eye = -normalize(pixel.along);
    surface_normal = film_normal(normal, to_eye);
    alpha = glossy_alpha(albedo.w);
    glossy_sum = 0.0f;
    dry = 1.0f - wetness * film_reflectance(dot(surface_normal, to_eye));
#endif
    vec3 added = vec3(albedo) * (dry * kReflects) *
                 direct_irradiance_of(light, pixel.position, normal,
                                      kPointOffset * grid.voxel_size, first_row, last_row);
    direct[index] += vec4(added, 0.0f);
#ifdef WET
    vec3 mirrored = wetness * glossy_sum * vec3(lights[light].intensity);
    specular[index] += vec4(mirrored, 0.0f);
    added += mirrored;
#endif
    beauty[index] += vec4(added, 0.0f);
}
