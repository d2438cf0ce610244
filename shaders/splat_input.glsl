// What the splatting passes read: the drawn chunks of one page and the batches over them.
layout(local_size_x = SPLAT_GROUP) in;
layout(std430, binding = BINDING_SURFELS) readonly buffer surfel_page { PackedSurfel surfels[]; };
layout(std430, binding = BINDING_DRAWN_CHUNKS) readonly buffer drawn_chunks { DrawnChunk chunks[]; };
layout(std430, binding = BINDING_SPLAT_BATCHES) readonly buffer splat_batches { SplatBatch batches[]; };
layout(location = 0) uniform uint batch_count;
layout(location = 1) uniform uint first_batch;

// This invocation's surfel, its disc and normal; false where there is none to draw.
bool this_splat(out PackedSurfel surfel, out Splat splat, out vec3 normal) {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (group >= batch_count) return false;
    SplatBatch batch = batches[first_batch + group];
    if (gl_LocalInvocationID.x >= batch.count) return false;
    surfel = surfels[batch.first + gl_LocalInvocationID.x];
    return splat_of(surfel, batch.rank + gl_LocalInvocationID.x, chunks[batch.chunk], splat,
                    normal);
}
