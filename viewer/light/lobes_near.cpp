#include "viewer/light/lobes_near.h"

namespace glowworm::gpu {

namespace {

constexpr std::size_t kKept = 256;
constexpr float kNowhere = 1e6f;  // leaf edges

struct Topics {
    std::span<const Node> nodes;
    std::span<const Lobe> lobes;
    LightGrid grid;

#include "shaders/octree.glsl"
};

std::size_t place_of(ivec3 cell) {
    const auto hash = [](int coordinate, uint factor) {
        return static_cast<uint>(coordinate) * factor;
    };
    return (hash(cell.x, 73856093u) ^ hash(cell.y, 19349663u) ^ hash(cell.z, 83492791u)) % kKept;
}

/// Of a leaf's or a node's cell `c`, 2^shift leaves wide, whether it reaches into low..high.
bool reaches(ivec3 c, int shift, ivec3 low, ivec3 high) {
    const ivec3 first = c << shift;
    const ivec3 last = first + ((1 << shift) - 1);
    return all(lessThanEqual(first, high)) && all(greaterThanEqual(last, low));
}

}  // namespace

LobesNear::LobesNear(std::span<const Node> nodes, std::span<const Lobe> lobes,
                     std::span<const LobeLight> lights, int depth)
    : nodes_(nodes), lobes_(lobes), lights_(lights), depth_(depth), kept_(kKept) {}

const LobesNear::Lobes& LobesNear::in_leaves(ivec3 low, ivec3 high) {
    Lobes& kept = kept_[place_of(low)];
    if (kept.low != low || kept.high != high) {
        kept.low = low;
        kept.high = high;
        kept.groups.clear();
        kept.lights.clear();
        find(kept);
    }
    return kept;
}

void LobesNear::find(Lobes& found) const {
    struct Place {
        uint node;
        int level;
        ivec3 cell;
    };
    if (nodes_.empty()) return;
    Topics topics{nodes_, lobes_, {}};
    Place stack[96];  // 7 siblings wait on each level at most, 13 levels
    int top = 0;
    stack[top++] = {0, 0, ivec3(0)};
    while (top > 0) {
        const Place at = stack[--top];
        const Node node = nodes_[at.node];
        if (at.level == depth_) {
            const uint last = node.first + topics.lobes_of_leaf(node.mask);
            for (uint i = node.first; i < last; ++i)
                add(i, topics.lobe_position(i), topics.lobe_normal(i), at.cell, found);
            continue;
        }
        uint child = node.first;
        for (int octant = 0; octant < 8; ++octant) {
            if (((node.mask >> octant) & 1u) == 0u) continue;
            const ivec3 cell = at.cell * 2 + ivec3(octant & 1, (octant >> 1) & 1, octant >> 2);
            if (reaches(cell, depth_ - at.level - 1, found.low, found.high))
                stack[top++] = {child, at.level + 1, cell};
            ++child;
        }
    }
}

void LobesNear::add(uint lobe, vec3 position, vec3 normal, ivec3 cell, Lobes& found) const {
    const std::size_t lane = found.lights.size() % kLanes;
    if (lane == 0) {
        Group& group = found.groups.emplace_back();
        for (Floats& coordinate : group.cell)
            coordinate = Floats{} + kNowhere;
    }
    Group& group = found.groups.back();
    for (int axis = 0; axis < 3; ++axis) {
        group.cell[axis][lane] = static_cast<float>(cell[axis]);
        group.position[axis][lane] = position[axis];
        group.normal[axis][lane] = normal[axis];
    }
    group.lobe[lane] = lobe;
    const LobeLight& light = lights_[lobe];
    Light& own = found.lights.emplace_back();
    own.irradiance = load(&light.irradiance);
    own.around = Floats{light.turn[0].w, light.turn[1].w, light.turn[2].w, 0.0f};
    for (int axis = 0; axis < 3; ++axis)
        own.along[axis] =
            Floats{light.turn[0][axis], light.turn[1][axis], light.turn[2][axis], 0.0f};
}

}  // namespace glowworm::gpu
