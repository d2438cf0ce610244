#include "preprocess/moving.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "preprocess/depth_image.h"
#include "preprocess/kd_tree.h"

namespace glowworm {
namespace {

/// How much nearer than the surface behind it a place must be to be contradicted, m: well above
/// the range noise and the error of the poses.
constexpr float kMargin = 0.10f;
/// How near another scan's point must be to confirm a place, m.
constexpr float kConfirms = 0.05f;

}  // namespace

std::vector<std::vector<std::uint32_t>> standing_points(std::span<const PlacedView> views) {
    std::vector<DepthImage> images;
    std::vector<KdTree> trees;
    for (const PlacedView& view : views) {
        images.emplace_back(view.scan->points.positions);
        trees.emplace_back(view.scan->points.positions);
    }
    std::vector<std::vector<std::uint32_t>> standing(views.size());
    for (std::size_t a = 0; a < views.size(); ++a) {
        const std::vector<Vec3f>& positions = views[a].scan->points.positions;
        std::vector<std::uint8_t> keep(positions.size());
        std::vector<Eigen::Isometry3f> T_other_scan(views.size());
        for (std::size_t b = 0; b < views.size(); ++b) {
            T_other_scan[b] =
                (views[b].T_world_scan.inverse() * views[a].T_world_scan).cast<float>();
        }
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, positions.size(), 512), [&](const auto& range) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    if (!is_finite(positions[i])) continue;
                    bool through = false, confirmed = false;
                    for (std::size_t b = 0; b < views.size() && !confirmed; ++b) {
                        if (b == a) continue;
                        const Eigen::Vector3f p =
                            T_other_scan[b] *
                            Eigen::Vector3f(positions[i].x, positions[i].y, positions[i].z);
                        const Vec3f place{p.x(), p.y(), p.z()};
                        through = through || (views[b].scan->has_viewpoint &&
                                              images[b].at(place, kMargin) == Seen::kFree);
                        confirmed = trees[b].nearest(place, kConfirms).found();
                    }
                    keep[i] = confirmed || !through;
                }
            });
        for (std::uint32_t i = 0; i < keep.size(); ++i) {
            if (keep[i]) standing[a].push_back(i);
        }
    }
    return standing;
}

}  // namespace glowworm
