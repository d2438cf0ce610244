#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// A neighbour found: its index in the points the tree was made of, and how far it is.
struct Neighbour {
    std::uint32_t index = std::numeric_limits<std::uint32_t>::max();  ///< max: none
    float squared_distance = std::numeric_limits<float>::infinity();  ///< m²

    bool found() const { return index != std::numeric_limits<std::uint32_t>::max(); }
};

/// Exact nearest neighbours in three dimensions. Keeps its own copy of the points in tree order:
/// a query touches contiguous memory. Equal distances give the lower index, so results do not
/// depend on the order of building. Points that are not finite are left out.
class KdTree {
  public:
    KdTree() = default;
    explicit KdTree(std::span<const Vec3f> points);

    /// The nearest point nearer than `max_distance` metres, if there is one.
    Neighbour nearest(const Vec3f& query,
                      float max_distance = std::numeric_limits<float>::infinity()) const;

    /// Up to `result.size()` nearest points, nearest first; returns how many were found.
    std::size_t nearest(const Vec3f& query, std::span<Neighbour> result,
                        float max_distance = std::numeric_limits<float>::infinity()) const;

    std::size_t size() const { return points_.size(); }

  private:
    struct Node {
        float split = 0;
        std::uint32_t axis = 3;            ///< 3: a leaf
        std::uint32_t begin = 0, end = 0;  ///< range of points_
        std::uint32_t right = 0;           ///< the left child follows its parent
    };
    void build(std::uint32_t begin, std::uint32_t end, std::span<const Vec3f> points);
    template <typename Visit>
    void search(const Vec3f& query, float& bound, Visit visit) const;

    std::vector<Node> nodes_;
    std::vector<Vec3f> points_;
    std::vector<std::uint32_t> indices_;
};

}  // namespace glowworm
