// Area lights as the exact rectangles they are.
layout(std430, binding = BINDING_PANELS) readonly buffer visible_panels { Panel panels[]; };

// The nearest panel that a ray meets before `farthest`; -1 where there is none.
int nearest_panel(uint panel_count, vec3 origin, vec3 direction, float farthest, out float depth) {
    int nearest = -1;
    depth = farthest;
    for (uint i = 0u; i < panel_count; ++i) {
        vec3 u = panels[i].edge_u.xyz, v = panels[i].edge_v.xyz;
        vec3 normal = cross(u, v);
        float t = dot(normal, panels[i].corner.xyz - origin) / dot(normal, direction);
        vec3 at = origin + direction * t - panels[i].corner.xyz;
        vec2 place = vec2(dot(at, u) / dot(u, u), dot(at, v) / dot(v, v));
        if (t > 0.0 && t < depth && all(greaterThanEqual(place, vec2(0.0))) &&
            all(lessThanEqual(place, vec2(1.0)))) {
            nearest = int(i);
            depth = t;
        }
    }
    return nearest;
}
