#ifndef FLOATS
#define FLOATS float   // or those of some pixels beside each other (viewer/gpu/lanes.h)
#endif
#ifndef INTS
#define INTS int
#define TO_INTS(values) int(values)
#endif

// Weighted sums over the discs at a pixel, in fixed point: integer sums do not depend on their
// order, so the same frame gives the same bits.
CONSTANT uint kFarthest = 0x7f800000u;   // depth where nothing was hit: +infinity
// The least weight (splat.glsl) is 256 of these units: a dark wall's colour is right where nothing but
// the outer part of one disc reaches. Eight thousand discs may lie over each other in full.
CONSTANT float kFixedOne = 262144.0f;
CONSTANT float kHalfUnit = 0.5f;   // what is added where a positive value is rounded down

// What one disc adds.
struct SurfaceShare {
    INTS normal_x, normal_y, normal_z;   // camera space
    INTS weight;
    INTS red, green, blue, ndf_length;
    INTS behind;                         // m behind the nearest
};

// Nothing where its weight is 0.
SurfaceShare share_of_surface(FLOATS weight, vec3 normal, vec3 albedo, float ndf_length,
                              FLOATS behind) {
    FLOATS w = weight * kFixedOne;
    SurfaceShare share;
    share.normal_x = TO_INTS(normal.x * w);
    share.normal_y = TO_INTS(normal.y * w);
    share.normal_z = TO_INTS(normal.z * w);
    share.weight = TO_INTS(w);
    share.red = TO_INTS(albedo.x * w + kHalfUnit);
    share.green = TO_INTS(albedo.y * w + kHalfUnit);
    share.blue = TO_INTS(albedo.z * w + kHalfUnit);
    share.ndf_length = TO_INTS(ndf_length * w + kHalfUnit);
    share.behind = TO_INTS(behind * w);
    return share;
}

// From the sums over all discs: xyz, the normal, w, the weight. Normal in the octree's frame; w:
// depth, 0 where nothing was hit.
vec4 mean_surface(ivec4 normal_sum, int behind_sum, float nearest) {
    if (normal_sum.w == 0) return vec4(0.0f);
    vec3 normal = octree_from_camera_direction(vec3(normal_sum));
    float depth = nearest + float(behind_sum) / float(normal_sum.w);
    return vec4(normal / max(length(normal), 1e-20f), depth);
}

// w: NDF length, that of the mean of the discs' NDF vectors.
vec4 mean_albedo(ivec4 normal_sum, ivec4 albedo_sum) {
    if (normal_sum.w == 0) return vec4(0.0f);
    float weight = float(normal_sum.w);
    vec4 albedo = vec4(albedo_sum) / weight;
    albedo.w *= min(length(vec3(normal_sum)) / weight, 1.0f);
    return albedo;
}
