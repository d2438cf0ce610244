#ifndef VIEW_GLSL
#define VIEW_GLSL
// The camera. Camera space: x right, y down in pixels, z forward in m along the view axis.
#ifndef __cplusplus
layout(std140, binding = BINDING_VIEW) uniform view_block { ViewBlock view; };
#endif

bool view_is_orthographic() { return view.right.w > 0.5f; }

vec3 camera_from_octree(vec3 position) {
    vec3 offset = position - vec3(view.position);
    return vec3(dot(offset, vec3(view.right)), dot(offset, vec3(view.down)),
                dot(offset, vec3(view.forward)));
}

vec3 camera_from_octree_direction(vec3 direction) {
    return vec3(dot(direction, vec3(view.right)), dot(direction, vec3(view.down)),
                dot(direction, vec3(view.forward)));
}

vec3 octree_from_camera_direction(vec3 direction) {
    return vec3(view.right) * direction.x + vec3(view.down) * direction.y +
           vec3(view.forward) * direction.z;
}

vec3 octree_from_camera(vec3 point) {
    return vec3(view.position) + octree_from_camera_direction(point);
}

// A pixel's ray in camera space, origin + depth * direction.
void camera_ray(vec2 pixel, OUT(vec3) origin, OUT(vec3) direction) {
    vec2 sideways = (pixel - vec2(view.down.w, view.forward.w)) / view.position.w;
    origin = view_is_orthographic() ? vec3(sideways, 0.0f) : vec3(0.0f);
    direction = view_is_orthographic() ? vec3(0.0f, 0.0f, 1.0f) : vec3(sideways, 1.0f);
}

// Pixels per m at a depth.
float pixels_per_metre(float depth) {
    return view_is_orthographic() ? view.position.w : view.position.w / depth;
}

vec2 pixel_of(vec3 camera_point) {
    return vec2(view.down.w, view.forward.w) + vec2(camera_point) * pixels_per_metre(camera_point.z);
}
#endif
