#ifndef TRACE_GLSL
#define TRACE_GLSL
// Exact rays through the octree: the twin of octree/trace.cpp, which says why each step is so.
#include "octree.glsl"

CONSTANT float kLeastOffset = 0.25f;     // leaf edges: how far a ray starts off its lobe
// Leaf edges: how far a ray starts off a point of the surface itself, which lies nearer to the
// samples than a leaf's mean does. More looks past the rims of what shadows the point, and lets light
// under the bumps of a wall that it grazes.
CONSTANT float kPointOffset = 0.03f;
CONSTANT float kSigmasOff = 3.0f;        // of the samples' scatter about the lobe's plane
CONSTANT float kLeastDistance = 0.5f;    // leaf edges: the surface it leaves is not met nearer
CONSTANT float kLeastBehind = 2.0f;      // leaf edges: nor from behind in the leaves round its own
CONSTANT float kSameSurface = 0.5f;      // cosine of 60 degrees
CONSTANT float kLampHeight = 0.5f;       // leaf edges: what is that near a lamp's plane is the lamp
CONSTANT float kLampCosine = 0.8f;       // and has a normal along its axis
CONSTANT int kMaxWalkDepth = 14;        // levels the walk remembers

// A walk through the cells, in leaf edges.
struct Walk {
    vec3 origin, direction, inverse;
    float t, t_end;   // leaf edges
    ivec3 cell;
    int known;        // path is right down to this level
    bool inside;
};

uint walk_path[kMaxWalkDepth + 1];

// Both bounds are at least 0, so what lies between is rounded down.
ivec3 cell_at(Walk w, ivec3 low, ivec3 high) {
    return ivec3(clamp(w.origin + w.direction * w.t, vec3(low), vec3(high)));
}

Walk begin_walk(vec3 origin, vec3 direction, float t_max) {
    Walk w;
    float per_edge = 1.0f / grid.voxel_size;
    float cells = float(1u << grid.depth);
    w.origin = (origin - cube_min()) * per_edge;
    vec3 small = vec3(direction.x < 0.0f ? -1e-9f : 1e-9f, direction.y < 0.0f ? -1e-9f : 1e-9f,
                      direction.z < 0.0f ? -1e-9f : 1e-9f);
    w.direction = mix(direction, small, lessThan(abs(direction), vec3(1e-9f)));
    w.inverse = 1.0f / w.direction;
    vec3 t0 = (vec3(0.0f) - w.origin) * w.inverse;
    vec3 t1 = (vec3(cells) - w.origin) * w.inverse;
    vec3 near = min(t0, t1);
    vec3 far = max(t0, t1);
    w.t = max(0.0f, max(near.x, max(near.y, near.z)));
    w.t_end = min(t_max * per_edge, min(far.x, min(far.y, far.z)));
    w.inside = w.t <= w.t_end;
    w.cell = cell_at(w, ivec3(0), ivec3((1 << int(grid.depth)) - 1));
    w.known = 0;
    walk_path[0] = 0u;
    return w;
}

// Down from the deepest node known to hold the cell. Returns the level of the empty cell, or
// depth + 1 where there is a leaf.
int descend(INOUT(Walk) w) {
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
void leave_cell(INOUT(Walk) w, int shift) {
    int size = 1 << shift;
    ivec3 low = (w.cell >> shift) << shift;
    vec3 face = vec3(low) + mix(vec3(0.0f), vec3(float(size)), greaterThan(w.direction, vec3(0.0f)));
    vec3 exit = (face - w.origin) * w.inverse;
    int axis = exit.y < exit.x ? (exit.z < exit.y ? 2 : 1) : (exit.z < exit.x ? 2 : 0);
    w.t = max(w.t, exit[axis]);
    if (w.t > w.t_end) {
        w.inside = false;
        return;
    }
    if (size > 1) w.cell = cell_at(w, low, low + size - 1);
    int next = w.direction[axis] > 0.0f ? low[axis] + size : low[axis] - 1;
    if (next < 0 || (next >> int(grid.depth)) != 0) {
        w.inside = false;
        return;
    }
    w.cell[axis] = next;
    w.known = min(w.known, int(grid.depth) - 1 - findMSB(uint(low[axis] ^ next)));
}

// Goes on to the next occupied leaf at or after the walk's cell; false when the ray has ended.
bool find_leaf(INOUT(Walk) w) {
    int depth = int(grid.depth);
    while (w.inside) {
        int empty_level = descend(w);
        if (empty_level > depth) return true;
        leave_cell(w, depth - empty_level);
    }
    return false;
}

// A leaf that a ray passes: its lobes, and where its cell lies.
struct LeafAhead {
    uint first, last;    // lobes
    uint surface_last;   // of them, those before this one are surface: one or two
    vec3 corner;         // m
};

LeafAhead leaf_ahead(Walk w) {
    Node node = nodes[walk_path[int(grid.depth)]];
    LeafAhead leaf;
    leaf.first = node.first;
    leaf.last = node.first + lobes_of_leaf(node.mask);
    leaf.surface_last = leaf.last;
    if (leaf.last - leaf.first > 1u &&
        (lobes[leaf.last - 1u].light != 0u || lobes[leaf.last - 1u].emission != 0u)) {
        --leaf.surface_last;
    }
    leaf.corner = cube_min() + vec3(w.cell) * grid.voxel_size;
    return leaf;
}

bool in_patch(uint lobe, vec3 corner, vec3 point) {
    float edge = grid.voxel_size;
    float margin = grid.patch_margin * lobes[lobe].spacing;
    vec3 at = point - corner;
    vec3 low = unpack_bytes(lobes[lobe].patch_min) * (edge / 255.0f) - margin;
    vec3 high = unpack_bytes(lobes[lobe].patch_max) * (edge / 255.0f) + margin;
    return all(greaterThanEqual(at, low)) && all(lessThanEqual(at, high)) &&
           all(lessThanEqual(abs(at - 0.5f * edge), vec3(grid.reach * edge)));
}

// Whether `point` on the plane of a lobe lies beyond the edge that it forms with the second surface
// of its leaf: outside the wedge where the edge is convex, in the rock where it is concave.
bool beyond_edge(uint lobe, uint other, vec3 point) {
    vec3 apart = lobe_position(lobe) - lobe_position(other);
    float side = dot(lobe_ndf(other), apart);
    float other_side = -dot(lobe_ndf(lobe), apart);
    if (side * other_side <= 0.0f) return false;   // they cross: not an edge
    float at = dot(lobe_ndf(other), point - lobe_position(other));
    return side < 0.0f ? at > 0.0f : at < 0.0f;
}

bool meets(LeafAhead leaf, uint lobe, vec3 point) {
    if (!in_patch(lobe, leaf.corner, point)) return false;
    if (leaf.surface_last - leaf.first != 2u || lobe >= leaf.surface_last) return true;
    return !beyond_edge(lobe, lobe == leaf.first ? leaf.first + 1u : leaf.first, point);
}

// The lobe whose front the ray meets first. A ray that slips between two pieces of plane and then
// meets a back side, or leaves the octree, takes the first front it passed by; else BURIED or
// NO_HIT. `from_normal` is that of the surface the ray leaves, which is not met before t_min.
uint trace_ray(vec3 origin, vec3 direction, vec3 from_normal, float t_min, float t_max) {
    Walk w = begin_walk(origin, direction, t_max);
    uint candidate = NO_HIT;
    while (find_leaf(w)) {
        LeafAhead leaf = leaf_ahead(w);
        float nearest = t_max;
        uint hit = NO_HIT;
        bool behind = false;
        for (uint i = leaf.first; i < leaf.last; ++i) {
            vec3 normal = lobe_ndf(i);
            vec3 offset = lobe_position(i) - origin;
            float slope = dot(normal, direction);
            float t = dot(normal, offset) / slope;
            float least = dot(normal, from_normal) > kSameSurface ? t_min : 0.0f;
            if (t >= least && t < nearest && meets(leaf, i, origin + direction * t)) {
                nearest = t;
                hit = i;
                behind = slope > 0.0f && lobes[i].light == 0u;   // a lamp's back is black, not rock
            } else if (slope < 0.0f && candidate == NO_HIT && dot(offset, direction) > least) {
                candidate = i;
            }
        }
        if (hit != NO_HIT) return !behind ? hit : candidate != NO_HIT ? candidate : BURIED;
        leave_cell(w, 0);
    }
    return candidate;
}

// Whether nothing, seen from either side, lies before t_max. `tag` is what the lobes of the lamp at
// the far end carry (0: none) and `lamp_normal` the lamp's (zero: no extent): its own samples, and a
// wall that it is mounted flush with, do not shadow it.
bool unoccluded(vec3 origin, vec3 direction, vec3 from_normal, float t_min, float t_max, uint tag,
                vec3 lamp_normal) {
    Walk w = begin_walk(origin, direction, t_max);
    vec3 end = origin + direction * t_max;
    while (find_leaf(w)) {
        LeafAhead leaf = leaf_ahead(w);
        for (uint i = leaf.first; i < leaf.last; ++i) {
            if (lobes[i].light != 0u && lobes[i].light == tag) continue;
            vec3 normal = lobe_ndf(i);
            float slope = dot(normal, direction);
            float t = dot(normal, lobe_position(i) - origin) / slope;
            float least = 0.0f;
            if (dot(normal, from_normal) > kSameSurface) {
                // A point of a bumpy wall may lie a little under the planes beside it.
                least = slope > 0.0f ? max(t_min, kLeastBehind * grid.voxel_size) : t_min;
            }
            if (!(t >= least && t <= t_max)) continue;
            vec3 point = origin + direction * t;
            if (!meets(leaf, i, point)) continue;
            bool lamps_wall = abs(dot(lamp_normal, point - end)) < kLampHeight * grid.voxel_size &&
                              abs(dot(lamp_normal, normal)) > kLampCosine;
            if (!lamps_wall) return false;
        }
        leave_cell(w, 0);
    }
    return true;
}

#ifndef UNOCCLUDED
#define UNOCCLUDED unoccluded   // what answers shadow rays, with the arguments of unoccluded()
#endif

// Whether a surface point sees `to`, starting off its plane by `offset` metres.
bool visible_from(vec3 from, vec3 normal, float offset, vec3 to, uint tag, vec3 lamp_normal) {
    vec3 start = from + normal * offset;
    vec3 way = to - start;
    float distance = length(way);
    float t_min = min(kLeastDistance * grid.voxel_size, 0.5f * distance);
    return distance <= 0.0f ||
           UNOCCLUDED(start, way / distance, normal, t_min, distance, tag, lamp_normal);
}

// Whether the surface point `from` sees `to`.
bool visible(vec3 from, vec3 normal, vec3 to) {
    return visible_from(from, normal, kPointOffset * grid.voxel_size, to, 0u, vec3(0.0f));
}
#endif
