#include "preprocess/surface/free_side.h"

#include <algorithm>
#include <cmath>

#include "octree/morton.h"

namespace glowworm {
namespace {

/// Rays march at most this many cells: a passage wider than that is a desert.
constexpr int kMarch = 400;

/// Cells next to the point that its own surface fills.
constexpr double kSkip = 3.0;

Vec3d across(const Vec3d& n) {
    const Vec3d axis = std::abs(n.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    return normalized(cross(n, axis));
}

}  // namespace

FreeSide::FreeSide(const SurfacePoints& points, float cell) : points_(&points) {
    const PointTree::Node& root = points.tree.nodes.front();
    const Vec3d size = vec3_cast<double>(root.high) - vec3_cast<double>(root.low);
    const double longest = std::max({size.x, size.y, size.z});
    low_ = vec3_cast<double>(root.low);
    cell_ = std::max(static_cast<double>(cell), longest / 2097151.0);
    if (!(cell_ > 0.0)) cell_ = 1.0;
    steps_ = kMarch;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3d c = (vec3_cast<double>(points.tree.position(i)) - low_) / cell_;
        const std::uint64_t code =
            morton_encode({static_cast<std::uint32_t>(c.x), static_cast<std::uint32_t>(c.y),
                           static_cast<std::uint32_t>(c.z)});
        if (codes_.empty() || codes_.back() != code) codes_.push_back(code);
    }
    std::sort(codes_.begin(), codes_.end());
    codes_.erase(std::unique(codes_.begin(), codes_.end()), codes_.end());
    codes_.shrink_to_fit();
}

bool FreeSide::is_occupied(const Vec3d& cell) const {
    const std::uint64_t code =
        morton_encode({static_cast<std::uint32_t>(cell.x), static_cast<std::uint32_t>(cell.y),
                       static_cast<std::uint32_t>(cell.z)});
    return std::binary_search(codes_.begin(), codes_.end(), code);
}

int FreeSide::vote(std::size_t i, const Vec3f& normal) const {
    const Vec3d n = vec3_cast<double>(normal);
    const Vec3d u = across(n);
    const Vec3d v = cross(n, u);
    const Vec3d directions[kRays] = {n, normalized(n + u * 0.6), normalized(n - u * 0.6),
                                     normalized(n + v * 0.6), normalized(n - v * 0.6)};
    const PointTree::Node& root = points_->tree.nodes.front();
    const Vec3d end = (vec3_cast<double>(root.high) - low_) / cell_;
    const Vec3d start = (vec3_cast<double>(points_->tree.position(i)) - low_) / cell_;
    const auto hits = [&](const Vec3d& direction) {
        for (int step = 0; step < steps_; ++step) {
            const Vec3d p = start + direction * (kSkip + 0.7 * step);
            if (!(p.x >= 0 && p.y >= 0 && p.z >= 0)) return false;
            if (!(p.x <= end.x && p.y <= end.y && p.z <= end.z)) return false;
            if (is_occupied(p)) return true;
        }
        return false;
    };
    int balance = 0;
    for (const Vec3d& direction : directions)
        balance += hits(direction) - hits(-direction);
    return balance;
}

}  // namespace glowworm
