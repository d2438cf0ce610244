// The sums of every pixel, as discs add to them.
layout(std430, binding = BINDING_NORMAL_SUMS) buffer pixel_normal_sums { ivec4 normal_sums[]; };
layout(std430, binding = BINDING_ALBEDO_SUMS) buffer pixel_albedo_sums { ivec4 albedo_sums[]; };
layout(std430, binding = BINDING_BEHIND_SUMS) buffer pixel_behind_sums { int behind_sums[]; };

void add_to_surface(uint pixel, SurfaceShare more) {
    atomicAdd(normal_sums[pixel].x, more.normal_x);
    atomicAdd(normal_sums[pixel].y, more.normal_y);
    atomicAdd(normal_sums[pixel].z, more.normal_z);
    atomicAdd(normal_sums[pixel].w, more.weight);
    atomicAdd(albedo_sums[pixel].x, more.red);
    atomicAdd(albedo_sums[pixel].y, more.green);
    atomicAdd(albedo_sums[pixel].z, more.blue);
    atomicAdd(albedo_sums[pixel].w, more.ndf_length);
    atomicAdd(behind_sums[pixel], more.behind);
}

void clear_surface(uint pixel) {
    normal_sums[pixel] = ivec4(0);
    albedo_sums[pixel] = ivec4(0);
    behind_sums[pixel] = 0;
}
