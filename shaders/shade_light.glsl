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
    if (wetness > 0.0f) \
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

// Whether light from what lies `to_lamp` off grazes a surface: not where this is positive.
ANY_FLOAT above_grazing(ANY_VEC3 normal, ANY_VEC3 to_lamp) {
    ANY_FLOAT height = dot(normal, to_lamp);
    return height * abs(height) - kGrazing * kGrazing * dot(to_lamp, to_lamp);
}

// How much of the light the lobes round a pixel agree that it sees.
float known_from_lobes(Pixel pixel) {
    vec3 to_lamp = vec3(lights[light].position) - pixel.position;
    if (lights[light].kind != LIGHT_AREA && above_grazing(vec3(pixel.surface), to_lamp) <= 0.0f) {
        return kPartlySeen;
    }
    uvec2 lamps = pixel_lamps[pixel.index];
    return (lamps.x & lamp_bit(light)) != 0u   ? kInFullView
           : (lamps.y & lamp_bit(light)) != 0u ? kHidden
                                               : kPartlySeen;
}

// A tile of 4 x 4 pixels looks at a light together. At an area light each pixel looks at 3 of a grid of
// 6 x 6 samples, each sample seen by one pixel at least: nothing that hides a sample from them all
// is missed, however thin. At a lamp without extent the pixels in the tile's corners and two
// between them look, where it is smaller than a leaf: no straight edge of a shadow is missed. Where they do not agree, or the pixels lie on different surfaces, the light is partly seen. For pixels that the
// lobes have looked for, these looks count.
CONSTANT uint kGrid = 6u, kLooks = 3u, kTile = 4u, kTilePixels = 16u;
CONSTANT float kSameDepth = 0.05f;      // of the depth
CONSTANT float kSameLeafDepth = 0.5f;   // leaf edges

// Whether a tile's pixels on the surface `first` and on this one see the same of a light.
bool looks_along(Pixel pixel, vec4 first) {
    float apart = abs(pixel.surface.w - first.w);
    return dot(vec3(pixel.surface), vec3(first)) > 0.9f && apart < kSameDepth * first.w &&
           (lights[light].kind == LIGHT_AREA ||
            (apart < kSameLeafDepth * grid.voxel_size &&
             float(kTile) <= grid.voxel_size * pixels_per_metre(first.w)));
}

// The looks of the pixel at `place` in its tile, whose first pixel is on the surface `first`: how many
// samples it sees and does not see; all of both where others look for it.
void look(Pixel pixel, uint place, vec4 first, OUT(uint) seen, OUT(uint) hidden) {
    seen = 0u;
    hidden = 0u;
    vec3 normal = vec3(pixel.surface);
    if (!looks_along(pixel, first)) return;
    float known = known_from_lobes(pixel);
    if (known != kPartlySeen) {
        seen = known == kInFullView ? kLooks : 0u;
        hidden = kLooks - seen;
        return;
    }
    Light at = lights[light];
    bool area = at.kind == LIGHT_AREA;
    if (!area && place % 3u != 0u) {   // the corners are 0, 3, 12 and 15
        seen = hidden = kLooks;
        return;
    }
    for (uint i = place; i < (area ? kLooks * kTilePixels : place + 1u); i += kTilePixels) {
        uint cell = i % (kGrid * kGrid);
        vec2 on_area = (vec2(cell % kGrid, cell / kGrid) + 0.5f) / float(kGrid);
        vec3 point = vec3(at.position);
        if (area) point += on_area.x * vec3(at.edge_u) + on_area.y * vec3(at.edge_v);
        vec3 to_lamp = point - pixel.position;
        // Below the horizon counts as neither: the light is cut by it.
        if (dot(normal, to_lamp) <= 0.0f || (area && dot(vec3(at.axis), to_lamp) >= 0.0f)) continue;
        uint looks = area ? 1u : kLooks;
        if (visible_from(pixel.position, normal, kPointOffset * grid.voxel_size, point, at.tag,
                         area ? vec3(at.axis) : vec3(0.0f))) {
            seen += looks;
        } else {
            hidden += looks;
        }
    }
}

// Of a tile whose pixels' looks see and do not see so many samples.
float how_much_seen(uint seen, uint hidden) {
    return seen == kLooks * kTilePixels     ? kInFullView
           : hidden == kLooks * kTilePixels ? kHidden
                                            : kPartlySeen;
}

// Adds the light, of an area light the given rows of samples; what its tile sees of it is in direct's w.
void shade_light(uvec2 at, int first_row, int last_row) {
    Pixel pixel = pixel_at(at);
    uint index = pixel.index;
    if (!can_be_lit(pixel)) return;
    float known = known_from_lobes(pixel);
    if (known == kPartlySeen) known = direct[index].w;
    if (known == kHidden) return;
    in_full_view = known == kInFullView;
    area_phase = (vec2(at.x % uint(sub_pixels), at.y % uint(sub_pixels)) + 0.5f) / float(sub_pixels);

    vec4 albedo = albedos[index];
    vec3 normal = vec3(pixel.surface);
    float dry = 1.0f;
#ifdef WET
    if (wetness > 0.0f) {
        to_eye = -normalize(pixel.along);
        surface_normal = film_normal(normal, to_eye);
        alpha = glossy_alpha(albedo.w);
        glossy_sum = 0.0f;
        dry = 1.0f - wetness * film_reflectance(dot(surface_normal, to_eye));
    }
#endif
    vec3 added = vec3(albedo) * (dry * kReflects) *
                 direct_irradiance_of(light, pixel.position, normal,
                                      kPointOffset * grid.voxel_size, first_row, last_row);
    direct[index] += vec4(added, 0.0f);
#ifdef WET
    if (wetness > 0.0f) {
        vec3 mirrored = wetness * glossy_sum * vec3(lights[light].intensity);
        specular[index] += vec4(mirrored, 0.0f);
        added += mirrored;
    }
#endif
    beauty[index] += vec4(added, 0.0f);
}
