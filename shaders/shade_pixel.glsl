#ifndef SHADE_PIXEL_GLSL
#define SHADE_PIXEL_GLSL
// The pixels that are shaded. The pass has them: surfaces, albedos, direct, indirect, specular,
// emission and beauty, row by row.
#include "view.glsl"

CONSTANT float kReflects = 1.0f / 3.14159265359f;   // radiance per radiosity, 1/sr

struct Pixel {
    uint index;
    vec4 surface;        // normal; w: depth, m, 0 where there is no surface
    vec3 eye, along;     // its ray, m and per m of depth
    vec3 position;       // m, of the surface
};

Pixel pixel_at(uvec2 at) {
    Pixel pixel;
    pixel.index = at.y * view.width + at.x;
    pixel.surface = surfaces[pixel.index];
    vec3 origin, ray;
    camera_ray(vec2(at) + 0.5f, origin, ray);
    pixel.eye = octree_from_camera(origin);
    pixel.along = octree_from_camera_direction(ray);
    pixel.position = pixel.eye + pixel.along * pixel.surface.w;
    return pixel;
}
#endif
