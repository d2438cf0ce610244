#ifndef TRACE_GLSL
#define TRACE_GLSL
// Exact rays through the octree: the twin of octree/trace.cpp, which says why each step is so.
#include "octree.glsl"

const float kLeastOffset = 0.25;     // leaf edges: how far a ray starts off its surface
const float kSigmasOff = 3.0;        // of the samples' scatter about the lobe's plane
const float kLeastDistance = 0.5;    // leaf edges: a lobe's own neighbours are not met
const float kLampHeight = 0.5;       // leaf edges: what is that near a lamp's plane is the lamp
const float kLampCosine = 0.8;       // and has a normal along its axis
const int kMaxWalkDepth = 14;        // levels the walk remembers

// A walk through the cells, in leaf edges.
struct Walk {
    vec3 origin, direction, inverse;
    float t, t_end;   // leaf edges
    ivec3 cell;
    int known;        // path is right down to this level
    bool inside;
};

uint walk_path[kMaxWalkDepth + 1];

ivec3 cell_at(Walk w, ivec3 low, ivec3 high) {
    return ivec3(clamp(floor(w.origin + w.direction * w.t), vec3(low), vec3(high)));
}

Walk begin_walk(vec3 origin, vec3 direction, float t_min, float t_max) {
    Walk w;
    float per_edge = 1.0 / grid.voxel_size;
    float cells = float(1u << grid.depth);
    w.origin = (origin - cube_min()) * per_edge;
    vec3 small = vec3(direction.x < 0.0 ? -1e-9 : 1e-9, direction.y < 0.0 ? -1e-9 : 1e-9,
                      direction.z < 0.0 ? -1e-9 : 1e-9);
    w.direction = mix(direction, small, lessThan(abs(direction), vec3(1e-9)));
    w.inverse = 1.0 / w.direction;
    vec3 t0 = (vec3(0.0) - w.origin) * w.inverse;
    vec3 t1 = (vec3(cells) - w.origin) * w.inverse;
    vec3 near = min(t0, t1);
    vec3 far = max(t0, t1);
    w.t = max(t_min * per_edge, max(near.x, max(near.y, near.z)));
    w.t_end = min(t_max * per_edge, min(far.x, min(far.y, far.z)));
    w.inside = w.t <= w.t_end;
    w.cell = cell_at(w, ivec3(0), ivec3((1 << int(grid.depth)) - 1));
    w.known = 0;
    walk_path[0] = 0u;
    return w;
}

// Down from the deepest node known to hold the cell. Returns the level of the empty cell, or
// depth + 1 where there is a leaf.
int descend(inout Walk w) {
    int depth = int(grid.depth);
    uint index = walk_path[w.known];
    for (int level = w.known; level < depth; ++level) {
        Node node = nodes[index];
        ivec3 bit = (w.cell >> (depth - level - 1)) & 1;
        uint octant = uint(bit.x | (bit.y << 1) | (bit.z << 2));
        if (((node.mask >> octant) & 1u) == 0u) {
            w.known = level;
            return level + 1;
        }
        index = node.first + uint(bitCount(node.mask & ((1u << octant) - 1u)));
        walk_path[level + 1] = index;
    }
    w.known = depth;
    return depth + 1;
}

// Steps over the cell of 2^shift leaves that the walk is in.
void leave_cell(inout Walk w, int shift) {
    int size = 1 << shift;
    ivec3 low = (w.cell >> shift) << shift;
    vec3 face = vec3(low) + mix(vec3(0.0), vec3(size), greaterThan(w.direction, vec3(0.0)));
    vec3 exit = (face - w.origin) * w.inverse;
    int axis = exit.y < exit.x ? (exit.z < exit.y ? 2 : 1) : (exit.z < exit.x ? 2 : 0);
    w.t = max(w.t, exit[axis]);
    if (w.t > w.t_end) {
        w.inside = false;
        return;
    }
    w.cell = cell_at(w, low, low + size - 1);
    int next = w.direction[axis] > 0.0 ? low[axis] + size : low[axis] - 1;
    if (next < 0 || (next >> int(grid.depth)) != 0) {
        w.inside = false;
        return;
    }
    w.cell[axis] = next;
    w.known = min(w.known, int(grid.depth) - 1 - findMSB(uint(low[axis] ^ next)));
}

// Goes on to the next occupied leaf at or after the walk's cell; false when the ray has ended.
bool find_leaf(inout Walk w) {
    int depth = int(grid.depth);
    while (w.inside) {
        int empty_level = descend(w);
        if (empty_level > depth) return true;
        leave_cell(w, depth - empty_level);
    }
    return false;
}

bool on_patch(uint lobe, vec3 corner, vec3 point) {
    float edge = grid.voxel_size;
    float margin = grid.patch_margin * lobes[lobe].spacing;
    vec3 at = point - corner;
    vec3 low = unpack_bytes(lobes[lobe].patch_min) * (edge / 255.0) - margin;
    vec3 high = unpack_bytes(lobes[lobe].patch_max) * (edge / 255.0) + margin;
    return all(greaterThanEqual(at, low)) && all(lessThanEqual(at, high)) &&
           all(lessThanEqual(abs(at - 0.5 * edge), vec3(grid.reach * edge)));
}

// The lobe whose front the ray meets first. A ray that slips between two pieces of plane and then
// meets a back side, or leaves the octree, takes the first front it passed by; else NO_HIT.
uint trace_ray(vec3 origin, vec3 direction, float t_min, float t_max) {
    Walk w = begin_walk(origin, direction, t_min, t_max);
    uint candidate = NO_HIT;
    while (find_leaf(w)) {
        vec3 corner = cube_min() + vec3(w.cell) * grid.voxel_size;
        float nearest = t_max;
        uint hit = NO_HIT;
        bool behind = false;
        Node leaf = nodes[walk_path[int(grid.depth)]];
        for (uint i = leaf.first; i < leaf.first + lobes_of_leaf(leaf.mask); ++i) {
            vec3 normal = lobe_ndf(i);
            vec3 offset = lobe_position(i) - origin;
            float slope = dot(normal, direction);
            float t = dot(normal, offset) / slope;
            if (t >= t_min && t < nearest && on_patch(i, corner, origin + direction * t)) {
                nearest = t;
                hit = i;
                behind = slope > 0.0;
            } else if (slope < 0.0 && candidate == NO_HIT && dot(offset, direction) > t_min) {
                candidate = i;
            }
        }
        if (hit != NO_HIT) return behind ? candidate : hit;
        leave_cell(w, 0);
    }
    return candidate;
}

// Whether nothing, seen from either side, lies between t_min and t_max. `tag` is what the lobes of
// the lamp at the far end carry (0: none) and `lamp_normal` the lamp's (zero: no extent): its own
// samples, and a wall that it is mounted flush with, do not shadow it.
bool unoccluded(vec3 origin, vec3 direction, float t_min, float t_max, uint tag, vec3 lamp_normal) {
    Walk w = begin_walk(origin, direction, t_min, t_max);
    vec3 end = origin + direction * t_max;
    while (find_leaf(w)) {
        vec3 corner = cube_min() + vec3(w.cell) * grid.voxel_size;
        Node leaf = nodes[walk_path[int(grid.depth)]];
        for (uint i = leaf.first; i < leaf.first + lobes_of_leaf(leaf.mask); ++i) {
            if (lobes[i].light != 0u && lobes[i].light == tag) continue;
            vec3 normal = lobe_ndf(i);
            float t = dot(normal, lobe_position(i) - origin) / dot(normal, direction);
            if (!(t >= t_min && t <= t_max)) continue;
            vec3 point = origin + direction * t;
            if (!on_patch(i, corner, point)) continue;
            bool lamps_wall = abs(dot(lamp_normal, point - end)) < kLampHeight * grid.voxel_size &&
                              abs(dot(lamp_normal, normal)) > kLampCosine;
            if (!lamps_wall) return false;
        }
        leave_cell(w, 0);
    }
    return true;
}

// Whether a surface point sees `to`, starting off its plane by `offset` metres.
bool visible_from(vec3 from, vec3 normal, float offset, vec3 to, uint tag, vec3 lamp_normal) {
    vec3 start = from + normal * offset;
    vec3 way = to - start;
    float distance = length(way);
    float t_min = min(kLeastDistance * grid.voxel_size, 0.5 * distance);
    return distance <= 0.0 || unoccluded(start, way / distance, t_min, distance, tag, lamp_normal);
}

// Whether the surface point `from` sees `to`.
bool visible(vec3 from, vec3 normal, vec3 to) {
    return visible_from(from, normal, kLeastOffset * grid.voxel_size, to, 0u, vec3(0.0));
}
#endif
