// Area lights as the exact rectangles they are.
#ifndef __cplusplus
layout(std430, binding = BINDING_PANELS) readonly buffer visible_panels { Panel panels[]; };
#endif

// The nearest panel that a ray meets before `farthest`; -1 where there is none.
int nearest_panel(uint panel_count, vec3 origin, vec3 direction, float farthest,
                  OUT(float) depth) {
    int nearest = -1;
    depth = farthest;
    for (uint i = 0u; i < panel_count; ++i) {
        vec3 u = vec3(panels[i].edge_u), v = vec3(panels[i].edge_v);
        vec3 normal = cross(u, v);
        float t = dot(normal, vec3(panels[i].corner) - origin) / dot(normal, direction);
        vec3 at = origin + direction * t - vec3(panels[i].corner);
        vec2 place = vec2(dot(at, u) / dot(u, u), dot(at, v) / dot(v, v));
        if (t > 0.0f && t < depth && all(greaterThanEqual(place, vec2(0.0f))) &&
            all(lessThanEqual(place, vec2(1.0f)))) {
            nearest = int(i);
            depth = t;
        }
    }
    return nearest;
}
