// What the splatting passes read: the drawn chunks of one page and the batches over them.
layout(local_size_x = SPLAT_GROUP) in;
layout(std430, binding = BINDING_SURFELS) readonly buffer surfel_page { PackedSurfel surfels[]; };
layout(std430, binding = BINDING_DRAWN_CHUNKS) readonly buffer drawn_chunks { DrawnChunk chunks[]; };
layout(std430, binding = BINDING_SPLAT_BATCHES) readonly buffer splat_batches { SplatBatch batches[]; };
layout(location = 0) uniform uint batch_count;
layout(location = 1) uniform uint first_batch;

// This invocation's surfel and its disc; false where there is none to draw.
bool this_splat(out PackedSurfel surfel, out Splat splat) {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (group >= batch_count) return false;
    SplatBatch batch = batches[first_batch + group];
    DrawnChunk chunk = chunks[batch.chunk];
    if (gl_LocalInvocationID.x >= batch.count) return false;
    surfel = surfels[batch.first + gl_LocalInvocationID.x];
    if (surfel_light(surfel) != 0u) return false;   // panels are drawn as exact rectangles
    vec3 position = surfel_position(surfel, chunk.box);
    if (any(lessThan(position, view.clip_low.xyz)) || any(greaterThan(position, view.clip_high.xyz))) {
        return false;
    }
    return make_splat(camera_from_octree(position),
                      camera_from_octree_direction(surfel_normal(surfel)),
                      surfel_radius(surfel) * chunk.scale, splat);
}
