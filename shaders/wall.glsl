#ifndef WALL_GLSL
#define WALL_GLSL
// Leaf edges: how far behind a wall another room begins, and how far from the middle of a wall's lobe
// the wall goes on.
CONSTANT float kBehindWall = 0.35f;
CONSTANT float kWallReach = 2.0f;

// Whether a wall, the plane round the lobe at `middle`, which rises beside the surface point `here`,
// stands between it and `there`. `edge`: a leaf's, m.
bool stands_between(vec3 normal, vec3 middle, float edge, vec3 here, vec3 there) {
    float behind = dot(normal, middle - there);
    if (behind < kBehindWall * edge) return false;
    float front = max(dot(normal, here - middle), 0.0f);
    vec3 aside = mix(here, there, front / (front + behind)) - middle;
    float reach = kWallReach * edge;
    return dot(aside, aside) < reach * reach;
}
#endif
