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
// How much of an area light a pixel sees. Only what is partly seen takes all samples.
const float kHidden = 0.0, kInFullView = 1.0, kPartlySeen = 2.0;
const int kLookRow = -1;   // as first_row: look at the light and keep in direct's w what is seen

struct Pixel {
    vec4 surface;     // normal; w: depth
    vec3 position, along;
};

// False where there is nothing to be lit: no surface, or a lamp itself.
bool lit_pixel(uint index, out Pixel pixel) {
    pixel.surface = surfaces[index];
    vec3 origin, ray;
    camera_ray(vec2(gl_GlobalInvocationID.xy) + 0.5, origin, ray);
    pixel.along = octree_from_camera_direction(ray);
    pixel.position = octree_from_camera(origin) + pixel.along * pixel.surface.w;
    return pixel.surface.w > 0.0 && emission[index].w <= 0.0;
}

// A tile of 4 x 4 pixels looks at a light together: each pixel at 3 of a grid of 6 x 6 samples, each
// sample seen by one pixel at least. Nothing that hides a sample from them all is missed, however
// thin; where they do not agree, or lie on different surfaces, the light is partly seen.
const uint kGrid = 6u, kLooks = 3u, kTilePixels = 16u;
shared vec4 tile_surface[4];   // that of the tile's first pixel
shared uint tile_seen[4], tile_hidden[4];

void look(uint index, bool inside) {
    uvec2 at = gl_LocalInvocationID.xy;
    uint tile = at.y / 4u * 2u + at.x / 4u, place = at.y % 4u * 4u + at.x % 4u;
    Pixel pixel;
    bool lit = inside && lit_pixel(index, pixel);
    if (place == 0u) {
        tile_surface[tile] = lit ? pixel.surface : vec4(0.0);
        tile_seen[tile] = 0u;
        tile_hidden[tile] = 0u;
    }
    memoryBarrierShared();
    barrier();
    vec4 first = tile_surface[tile];
    if (lit && dot(pixel.surface.xyz, first.xyz) > 0.9 &&
        abs(pixel.surface.w - first.w) < 0.05 * first.w) {
        Light area = lights[light];
        for (uint i = place; i < kLooks * kTilePixels; i += kTilePixels) {
            uint cell = i % (kGrid * kGrid);
            vec2 on_area = (vec2(cell % kGrid, cell / kGrid) + 0.5) / float(kGrid);
            vec3 point = area.position.xyz + on_area.x * area.edge_u.xyz +
                         on_area.y * area.edge_v.xyz;
            vec3 to_lamp = point - pixel.position;
            // Below the horizon counts as neither: the light is cut by it.
            if (dot(pixel.surface.xyz, to_lamp) <= 0.0 || dot(area.axis.xyz, to_lamp) >= 0.0) {
                continue;
            }
            bool sees = visible_from(pixel.position, pixel.surface.xyz,
                                     kPointOffset * grid.voxel_size, point, area.tag,
                                     area.axis.xyz);
            atomicAdd(tile_seen[tile], sees ? 1u : 0u);
            atomicAdd(tile_hidden[tile], sees ? 0u : 1u);
        }
    }
    memoryBarrierShared();
    barrier();
    if (!inside) return;
    direct[index].w = tile_seen[tile] == kLooks * kTilePixels     ? kInFullView
                      : tile_hidden[tile] == kLooks * kTilePixels ? kHidden
                                                                  : kPartlySeen;
}

void main() {
    bool inside = all(lessThan(gl_GlobalInvocationID.xy, uvec2(view.width, view.height)));
    uint index = gl_GlobalInvocationID.y * view.width + gl_GlobalInvocationID.x;
    if (first_row == kLookRow) {
        look(index, inside);
        return;
    }
    Pixel pixel;
    if (!inside || !lit_pixel(index, pixel)) return;
    if (lights[light].kind == LIGHT_AREA) {
        if (direct[index].w == kHidden) return;
        in_full_view = direct[index].w == kInFullView;
    }
    area_phase = (vec2(gl_GlobalInvocationID.xy % uint(sub_pixels)) + 0.5) / float(sub_pixels);

    vec4 albedo = albedos[index];
    vec3 normal = pixel.surface.xyz;
    float dry = 1.0;
#ifdef WET
    to_eye = -normalize(pixel.along);
    surface_normal = film_normal(normal, to_eye);
    alpha = glossy_alpha(albedo.w);
    dry = 1.0 - wetness * film_reflectance(dot(surface_normal, to_eye));
#endif
    vec3 added = albedo.rgb * (dry / kPi) *
                 direct_irradiance_of(light, pixel.position, normal,
                                      kPointOffset * grid.voxel_size, first_row, last_row);
    direct[index].rgb += added;
#ifdef WET
    vec3 mirrored = wetness * glossy_sum * lights[light].intensity.rgb;
    specular[index].rgb += mirrored;
    added += mirrored;
#endif
    beauty[index].rgb += added;
}
