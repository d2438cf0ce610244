#include "preprocess/register/orient.h"

#include <array>
#include <cmath>
#include <queue>

namespace glowworm {
namespace {

constexpr std::size_t kNeighbours = 9;

struct Edge {
    float cost;
    std::uint32_t from, to;
    bool operator<(const Edge& o) const {  // a priority queue gives the greatest first
        if (cost != o.cost) return cost > o.cost;
        return to != o.to ? to > o.to : from > o.from;
    }
};

}  // namespace

void face_viewpoint(std::span<const Vec3f> positions, std::span<Vec3f> normals,
                    const Vec3f& viewpoint) {
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (dot(normals[i], viewpoint - positions[i]) < 0.0f) normals[i] = -normals[i];
    }
}

void agree_with_neighbours(std::span<const Vec3f> positions, std::span<Vec3f> normals,
                           const KdTree& tree) {
    Vec3d middle;
    for (const Vec3f& p : positions)
        middle += vec3_cast<double>(p);
    const Vec3f centre =
        vec3_cast<float>(middle / static_cast<double>(std::max<std::size_t>(1, positions.size())));
    std::vector<std::uint8_t> done(positions.size());
    for (std::uint32_t root = 0; root < positions.size(); ++root) {
        if (done[root]) continue;
        std::vector<std::uint32_t> piece;
        double outward = 0.0;
        std::priority_queue<Edge> open;
        open.push({0.0f, root, root});
        while (!open.empty()) {
            const Edge edge = open.top();
            open.pop();
            if (done[edge.to]) continue;
            done[edge.to] = 1;
            Vec3f& n = normals[edge.to];
            if (dot(n, normals[edge.from]) < 0.0f) n = -n;
            piece.push_back(edge.to);
            outward += static_cast<double>(dot(n, positions[edge.to] - centre));
            std::array<Neighbour, kNeighbours> found;
            const std::size_t count = tree.nearest(positions[edge.to], found);
            for (std::size_t i = 0; i < count; ++i) {
                const std::uint32_t to = found[i].index;
                if (!done[to]) open.push({1.0f - std::abs(dot(n, normals[to])), edge.to, to});
            }
        }
        if (outward < 0.0) {
            for (const std::uint32_t i : piece)
                normals[i] = -normals[i];
        }
    }
}

}  // namespace glowworm
