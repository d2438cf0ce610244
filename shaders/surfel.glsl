#ifndef __cplusplus
// A point of the cloud as the file holds it: PackedSurfel of octree/node_layout.h.
struct PackedSurfel {
    uint position_xy;
    uint position_z_radius;
    uint normal;
    uint albedo_ndf;
    uint station_light;
};
#endif

vec3 surfel_position(PackedSurfel surfel, vec4 box) {
    vec3 q = vec3(surfel.position_xy & 0xffffu, surfel.position_xy >> 16,
                  surfel.position_z_radius & 0xffffu);
    return vec3(box) + (q + 0.5f) * (box.w / 65536.0f);
}

float surfel_radius(PackedSurfel surfel) {
    return unpackHalf2x16(surfel.position_z_radius).y;
}

// Octahedral map (Cigolle et al. 2014).
vec3 surfel_normal(PackedSurfel surfel) {
    vec2 e = unpackSnorm2x16(surfel.normal);
    vec3 n = vec3(e, 1.0f - abs(e.x) - abs(e.y));
    float fold = max(-n.z, 0.0f);
    n.x += n.x >= 0.0f ? -fold : fold;
    n.y += n.y >= 0.0f ? -fold : fold;
    return normalize(n);
}

float linear_from_srgb(uint value) {   // 0..255
    float encoded = float(value) / 255.0f;
    return encoded <= 0.04045f ? encoded / 12.92f : pow((encoded + 0.055f) / 1.055f, 2.4f);
}

#ifndef LINEAR_FROM_SRGB
#define LINEAR_FROM_SRGB linear_from_srgb   // or a table of it
#endif
vec3 surfel_albedo(PackedSurfel surfel) {
    uint rgb = surfel.albedo_ndf;
    return vec3(LINEAR_FROM_SRGB(rgb & 255u), LINEAR_FROM_SRGB((rgb >> 8) & 255u),
                LINEAR_FROM_SRGB((rgb >> 16) & 255u));
}

float surfel_ndf_length(PackedSurfel surfel) { return float(surfel.albedo_ndf >> 24) / 255.0f; }

// 0: none, else 1 + index of the area light whose panel it is a sample of.
uint surfel_light(PackedSurfel surfel) { return surfel.station_light >> 16; }
