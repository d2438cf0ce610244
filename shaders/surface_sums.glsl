// Weighted sums over the discs at a pixel, in fixed point: integer sums do not depend on their
// order, so the same frame gives the same bits.
layout(std430, binding = BINDING_NORMAL_SUMS) buffer pixel_normal_sums { ivec4 normal_sums[]; };   // camera space; w: weight
layout(std430, binding = BINDING_ALBEDO_SUMS) buffer pixel_albedo_sums { uvec4 albedo_sums[]; };   // w: NDF length
layout(std430, binding = BINDING_BEHIND_SUMS) buffer pixel_behind_sums { int behind_sums[]; };     // m behind the nearest

const uint kFarthest = 0x7f800000u;   // depth where nothing was hit: +infinity
const float kFixedOne = 65536.0;
const float kLeastWeight = 1.0 / 4096.0;

void add_to_surface(uint pixel, float weight, vec3 normal, vec3 albedo, float ndf_length,
                    float behind) {
    float w = max(weight, kLeastWeight) * kFixedOne;
    ivec4 n = ivec4(round(vec4(normal, 1.0) * w));
    uvec4 a = uvec4(vec4(albedo, ndf_length) * w + 0.5);
    atomicAdd(normal_sums[pixel].x, n.x);
    atomicAdd(normal_sums[pixel].y, n.y);
    atomicAdd(normal_sums[pixel].z, n.z);
    atomicAdd(normal_sums[pixel].w, n.w);
    atomicAdd(albedo_sums[pixel].x, a.x);
    atomicAdd(albedo_sums[pixel].y, a.y);
    atomicAdd(albedo_sums[pixel].z, a.z);
    atomicAdd(albedo_sums[pixel].w, a.w);
    atomicAdd(behind_sums[pixel], int(round(behind * w)));
}

void clear_surface(uint pixel) {
    normal_sums[pixel] = ivec4(0);
    albedo_sums[pixel] = uvec4(0u);
    behind_sums[pixel] = 0;
}
