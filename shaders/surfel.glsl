// A point of the cloud as the file holds it: PackedSurfel of octree/node_layout.h.
struct PackedSurfel {
    uint position_xy;
    uint position_z_radius;
    uint normal;
    uint albedo_ndf;
    uint station_light;
};

vec3 surfel_position(PackedSurfel surfel, vec4 box) {
    vec3 q = vec3(surfel.position_xy & 0xffffu, surfel.position_xy >> 16,
                  surfel.position_z_radius & 0xffffu);
    return box.xyz + (q + 0.5) * (box.w / 65536.0);
}

float surfel_radius(PackedSurfel surfel) {
    return unpackHalf2x16(surfel.position_z_radius).y;
}

// Octahedral map (Cigolle et al. 2014).
vec3 surfel_normal(PackedSurfel surfel) {
    vec2 e = unpackSnorm2x16(surfel.normal);
    vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
    float fold = max(-n.z, 0.0);
    n.xy += vec2(n.x >= 0.0 ? -fold : fold, n.y >= 0.0 ? -fold : fold);
    return normalize(n);
}

vec3 surfel_albedo(PackedSurfel surfel) {
    vec3 srgb = unpackUnorm4x8(surfel.albedo_ndf).rgb;
    return mix(pow((srgb + 0.055) / 1.055, vec3(2.4)), srgb / 12.92, lessThanEqual(srgb, vec3(0.04045)));
}

float surfel_ndf_length(PackedSurfel surfel) { return unpackUnorm4x8(surfel.albedo_ndf).w; }

// 0: none, else 1 + index of the area light whose panel it is a sample of.
uint surfel_light(PackedSurfel surfel) { return surfel.station_light >> 16; }
