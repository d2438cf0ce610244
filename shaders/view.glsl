// The camera. Camera space: x right, y down in pixels, z forward in m along the view axis.
layout(std140, binding = BINDING_VIEW) uniform view_block { ViewBlock view; };

bool view_is_orthographic() { return view.right.w > 0.5; }

vec3 camera_from_octree(vec3 position) {
    vec3 offset = position - view.position.xyz;
    return vec3(dot(offset, view.right.xyz), dot(offset, view.down.xyz),
                dot(offset, view.forward.xyz));
}

vec3 camera_from_octree_direction(vec3 direction) {
    return vec3(dot(direction, view.right.xyz), dot(direction, view.down.xyz),
                dot(direction, view.forward.xyz));
}

vec3 octree_from_camera_direction(vec3 direction) {
    return view.right.xyz * direction.x + view.down.xyz * direction.y +
           view.forward.xyz * direction.z;
}

vec3 octree_from_camera(vec3 point) {
    return view.position.xyz + octree_from_camera_direction(point);
}

// A pixel's ray in camera space, origin + depth * direction.
void camera_ray(vec2 pixel, out vec3 origin, out vec3 direction) {
    vec2 sideways = (pixel - vec2(view.down.w, view.forward.w)) / view.position.w;
    origin = view_is_orthographic() ? vec3(sideways, 0.0) : vec3(0.0);
    direction = view_is_orthographic() ? vec3(0.0, 0.0, 1.0) : vec3(sideways, 1.0);
}

// Pixels per m at a depth.
float pixels_per_metre(float depth) {
    return view_is_orthographic() ? view.position.w : view.position.w / depth;
}

vec2 pixel_of(vec3 camera_point) {
    return vec2(view.down.w, view.forward.w) + camera_point.xy * pixels_per_metre(camera_point.z);
}
