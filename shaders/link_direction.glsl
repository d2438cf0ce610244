#ifndef LINK_DIRECTION_GLSL
#define LINK_DIRECTION_GLSL
// Directions of gather rays: the twin of link_direction in octree/links.cpp.

// Bijective scramble of 32 bits (PCG's output function).
uint scramble(uint value) {
    uint state = value * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

float unit_fraction(uint fixed_point) { return float(fixed_point >> 8u) * (1.0 / 16777216.0); }

vec3 cosine_direction(float u, float v, vec3 normal) {
    float sine = sqrt(u);
    float angle = 6.28318530718 * v;
    float s = normal.z < 0.0 ? -1.0 : 1.0;
    float a = -1.0 / (s + normal.z);
    float b = normal.x * normal.y * a;
    vec3 tangent = vec3(1.0 + s * normal.x * normal.x * a, s * b, -s * normal.x);
    vec3 bitangent = vec3(b, s + normal.y * normal.y * a, -normal.y);
    return tangent * (sine * cos(angle)) + bitangent * (sine * sin(angle)) +
           normal * sqrt(1.0 - u);
}

vec3 link_direction(uint lobe, uint ray, vec3 normal) {
    uint seed = scramble(lobe);
    float u = unit_fraction(seed + (ray + 1u) * 3242174889u);
    float v = unit_fraction(scramble(seed) + (ray + 1u) * 2447445414u);
    return cosine_direction(u, v, normal);
}
#endif
