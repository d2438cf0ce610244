#include "octree/trace.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace glowworm {

namespace {

constexpr float kLeastOffset = 0.25f;   // of a leaf edge: how far a ray starts off its lobe
constexpr float kSigmasOff = 3.0f;      // of the samples' scatter about the lobe's plane
constexpr float kLeastDistance = 0.5f;  // leaf edges: a lobe's own neighbours are not met
constexpr float kLeastBehind = 2.0f;    // leaf edges: nor from behind in the leaves round its own
constexpr float kSameSurface = 0.5f;    // cosine of 60 degrees
constexpr float kLampHeight = 0.5f;     // leaf edges: what is that near a lamp's plane is the lamp
constexpr float kLampCosine = 0.8f;     // and has a normal along its axis

/// How many bits a child mask has: std::popcount is a call where the processor is any x86-64.
constexpr std::array<std::uint8_t, 256> kBitsIn = [] {
    std::array<std::uint8_t, 256> bits{};
    for (unsigned mask = 0; mask < 256; ++mask)
        bits[mask] = static_cast<std::uint8_t>(std::popcount(mask));
    return bits;
}();

/// The walk of a ray through the cells of the octree, in units of a leaf's edge.
class CellWalk {
  public:
    CellWalk(const OctreeView& octree, const Ray& ray)
        : nodes_(octree.nodes.data()), depth_(static_cast<int>(octree.grid.depth)) {
        edge_ = octree.grid.voxel_size();
        const float per_edge = 1.0f / edge_;
        const auto cells = static_cast<float>(1u << depth_);
        float enter = 0.0f;
        float leave = ray.t_max * per_edge;
        for (int a = 0; a < 3; ++a) {
            origin_[a] = (ray.origin[a] - octree.grid.cube_min[a]) * per_edge;
            const float d = ray.direction[a];
            const float safe = std::abs(d) < 1e-9f ? std::copysign(1e-9f, d) : d;
            direction_[a] = safe;
            inverse_[a] = 1.0f / safe;
            const float t0 = (0.0f - origin_[a]) * inverse_[a];
            const float t1 = (cells - origin_[a]) * inverse_[a];
            enter = std::max(enter, std::min(t0, t1));
            leave = std::min(leave, std::max(t0, t1));
        }
        t_ = enter;
        t_end_ = leave;
        inside_ = !octree.nodes.empty() && enter <= leave;
        for (int a = 0; a < 3; ++a) {
            cell_[a] = cell_of(a, 0, (1 << depth_) - 1);
        }
        path_[0] = 0;
    }

    /// Goes on to the next occupied leaf; false when the ray has ended. Call it once before the
    /// first leaf.
    bool next_leaf() {
        if (!started_) {
            started_ = true;
        } else {
            leave_cell(0);
        }
        while (inside_) {
            const int empty_level = descend();
            if (empty_level > depth_) return true;
            leave_cell(depth_ - empty_level);
        }
        return false;
    }

    const Node& leaf() const { return nodes_[path_[static_cast<std::size_t>(depth_)]]; }
    int cell(int axis) const { return cell_[axis]; }

  private:
    /// Both bounds are at least 0, so what lies between is rounded down.
    int cell_of(int axis, int low, int high) const {
        const float at = origin_[axis] + direction_[axis] * t_;
        return static_cast<int>(std::clamp(at, static_cast<float>(low), static_cast<float>(high)));
    }

    /// Down from the deepest node known to hold the cell. Returns the level of the empty cell, or
    /// depth + 1 where there is a leaf.
    int descend() {
        for (int level = known_; level < depth_; ++level) {
            const Node& node = nodes_[path_[static_cast<std::size_t>(level)]];
            const int shift = depth_ - level - 1;
            const unsigned octant =
                static_cast<unsigned>(((cell_[0] >> shift) & 1) | (((cell_[1] >> shift) & 1) << 1) |
                                      (((cell_[2] >> shift) & 1) << 2));
            if (((node.mask >> octant) & 1u) == 0) {
                known_ = level;
                return level + 1;
            }
            path_[static_cast<std::size_t>(level) + 1] =
                node.first + kBitsIn[node.mask & ((1u << octant) - 1u)];
        }
        known_ = depth_;
        return depth_ + 1;
    }

    /// Steps over the cell of 2^shift leaves that the walk is in.
    void leave_cell(int shift) {
        const int size = 1 << shift;
        int axis = 0;
        float exit = 0.0f;
        std::array<int, 3> low{};
        for (int a = 0; a < 3; ++a) {
            low[static_cast<std::size_t>(a)] = (cell_[a] >> shift) << shift;
            const int face = low[static_cast<std::size_t>(a)] + (direction_[a] > 0.0f ? size : 0);
            const float t = (static_cast<float>(face) - origin_[a]) * inverse_[a];
            if (a == 0 || t < exit) {
                axis = a;
                exit = t;
            }
        }
        t_ = std::max(t_, exit);
        if (t_ > t_end_) {
            inside_ = false;
            return;
        }
        for (int a = 0; a < 3; ++a) {
            const int at = low[static_cast<std::size_t>(a)];
            if (a != axis) {
                if (size > 1) cell_[a] = cell_of(a, at, at + size - 1);
                continue;
            }
            const int next = direction_[a] > 0.0f ? at + size : at - 1;
            if (next < 0 || next >> depth_ != 0) {
                inside_ = false;
                return;
            }
            // Whatever lies above the highest bit that changed is still the same.
            const auto changed = static_cast<unsigned>(at ^ next);
            known_ = std::min(known_, depth_ - static_cast<int>(std::bit_width(changed)));
            cell_[a] = next;
        }
    }

    const Node* nodes_;
    int depth_;
    float edge_ = 0.0f;
    Vec3f origin_, direction_, inverse_;
    float t_ = 0.0f, t_end_ = 0.0f;
    Vec3<int> cell_;
    int known_ = 0;                                    // path_ is right down to this level
    std::array<std::uint32_t, kMaxDepth + 1> path_{};  // nodes from the root to the cell
    bool inside_ = false, started_ = false;
};

Vec3f vector_of(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

Vec3f unpack_bytes(std::uint32_t packed) {
    return {static_cast<float>(packed & 255u), static_cast<float>((packed >> 8) & 255u),
            static_cast<float>((packed >> 16) & 255u)};
}

/// Of a leaf's two or three lobes the last: whether it is no surface but a lamp.
bool emits(const Lobe& lobe) {
    return lobe.light != 0 || lobe.emission != 0;
}

/// A leaf that a ray passes: its lobes, and where its cell lies.
struct LeafAhead {
    std::uint32_t first, last;   // lobes
    std::uint32_t surface_last;  // of them, those before this one are surface: one or two
    Vec3f corner;                // m: the cell's lower corner
    float edge;                  // m

    LeafAhead(const OctreeView& octree, const CellWalk& walk) : edge(octree.grid.voxel_size()) {
        first = walk.leaf().first;
        last = first + ((walk.leaf().mask >> 8) & 3u);
        surface_last = last;
        if (last - first > 1 && emits(octree.lobes[last - 1])) --surface_last;
        corner = {octree.grid.cube_min.x + static_cast<float>(walk.cell(0)) * edge,
                  octree.grid.cube_min.y + static_cast<float>(walk.cell(1)) * edge,
                  octree.grid.cube_min.z + static_cast<float>(walk.cell(2)) * edge};
    }
};

/// Whether `point` on a lobe's plane lies within the box of its piece, `margin` metres wider.
bool in_patch(const Lobe& lobe, const LeafAhead& leaf, float margin, float reach,
              const Vec3f& point) {
    const Vec3f low = unpack_bytes(lobe.patch_min);
    const Vec3f high = unpack_bytes(lobe.patch_max);
    const float scale = leaf.edge / 255.0f;
    for (int a = 0; a < 3; ++a) {
        const float at = point[a] - leaf.corner[a];
        if (at < low[a] * scale - margin || at > high[a] * scale + margin) return false;
        if (std::abs(at - 0.5f * leaf.edge) > reach * leaf.edge) return false;
    }
    return true;
}

/// Whether `point` on the plane of `lobe` lies beyond the edge that it forms with `other`, the
/// second surface of its leaf: outside the wedge where the edge is convex, in the rock where it is
/// concave.
bool beyond_edge(const Lobe& lobe, const Lobe& other, const Vec3f& point) {
    const Vec3f apart = vector_of(lobe.position) - vector_of(other.position);
    const float side = dot(vector_of(other.ndf), apart);  // of this lobe on the other's plane
    const float other_side = -dot(vector_of(lobe.ndf), apart);
    if (side * other_side <= 0.0f) return false;  // they cross: not an edge
    const float at = dot(vector_of(other.ndf), point - vector_of(other.position));
    return side < 0.0f ? at > 0.0f : at < 0.0f;
}

/// Whether the ray meets lobe `i` of the leaf at distance t along it.
bool meets(const OctreeView& octree, const TraceSettings& settings, const LeafAhead& leaf,
           const Ray& ray, std::uint32_t i, float t) {
    const Lobe& lobe = octree.lobes[i];
    const Vec3f point = ray.origin + ray.direction * t;
    if (!in_patch(lobe, leaf, settings.patch_margin * lobe.spacing, settings.reach, point)) {
        return false;
    }
    if (leaf.surface_last - leaf.first != 2 || i >= leaf.surface_last) return true;
    const std::uint32_t other = i == leaf.first ? leaf.first + 1 : leaf.first;
    return !beyond_edge(lobe, octree.lobes[other], point);
}

/// The surface that a ray leaves is not met right after.
float least_t(const Ray& ray, const Vec3f& normal) {
    return dot(normal, ray.normal) > kSameSurface ? ray.t_min : 0.0f;
}

}  // namespace

TraceHit trace_ray(const OctreeView& octree, const TraceSettings& settings, const Ray& ray) {
    CellWalk walk(octree, ray);
    TraceHit candidate;
    while (walk.next_leaf()) {
        const LeafAhead leaf(octree, walk);
        TraceHit nearest{kNoHit, ray.t_max};
        bool behind = false;
        for (std::uint32_t i = leaf.first; i < leaf.last; ++i) {
            const Lobe& lobe = octree.lobes[i];
            const Vec3f normal = vector_of(lobe.ndf);
            const Vec3f offset = vector_of(lobe.position) - ray.origin;
            const float slope = dot(normal, ray.direction);
            const float t = dot(normal, offset) / slope;
            const float t_min = least_t(ray, normal);
            if (t >= t_min && t < nearest.t && meets(octree, settings, leaf, ray, i, t)) {
                nearest = {i, t};
                behind = slope > 0.0f && lobe.light == 0;  // a lamp's back is black, not rock
            } else if (slope < 0.0f && candidate.lobe == kNoHit &&
                       dot(offset, ray.direction) > t_min) {
                candidate = {i, t};
            }
        }
        if (nearest.lobe == kNoHit) continue;
        if (!behind) return nearest;
        return candidate.lobe != kNoHit ? candidate : TraceHit{kBuried, nearest.t};
    }
    return candidate;
}

bool is_unoccluded(const OctreeView& octree, const TraceSettings& settings, const Ray& ray,
                   const ShadowTarget& target) {
    CellWalk walk(octree, ray);
    const Vec3f end = ray.origin + ray.direction * ray.t_max;
    while (walk.next_leaf()) {
        const LeafAhead leaf(octree, walk);
        for (std::uint32_t i = leaf.first; i < leaf.last; ++i) {
            const Lobe& lobe = octree.lobes[i];
            if (lobe.light != 0 && lobe.light == target.light) continue;
            const Vec3f normal = vector_of(lobe.ndf);
            const float slope = dot(normal, ray.direction);
            const float t = dot(normal, vector_of(lobe.position) - ray.origin) / slope;
            float least = least_t(ray, normal);
            // A point of a bumpy wall may lie a little under the planes beside it.
            if (slope > 0.0f && dot(normal, ray.normal) > kSameSurface) {
                least = std::max(least, kLeastBehind * leaf.edge);
            }
            if (!(t >= least && t <= ray.t_max)) continue;
            if (!meets(octree, settings, leaf, ray, i, t)) continue;
            const Vec3f point = ray.origin + ray.direction * t;
            const bool lamps_wall =
                std::abs(dot(target.normal, point - end)) < kLampHeight * leaf.edge &&
                std::abs(dot(target.normal, normal)) > kLampCosine;
            if (!lamps_wall) return false;
        }
    }
    return true;
}

Ray ray_from_lobe(const OctreeView& octree, const Lobe& lobe, const Vec3f& direction) {
    const float edge = octree.grid.voxel_size();
    const Vec3f normal = normalized(vector_of(lobe.ndf));
    const float offset = std::max(kLeastOffset * edge, kSigmasOff * lobe.plane_sigma);
    return {vector_of(lobe.position) + normal * offset, direction, normal, kLeastDistance * edge};
}

}  // namespace glowworm
