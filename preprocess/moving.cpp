#include "preprocess/moving.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <optional>

#include "preprocess/clean.h"
#include "preprocess/depth_image.h"
#include "preprocess/kd_tree.h"

namespace glowworm {
namespace {

/// How much nearer than the surface behind it a place must be to be contradicted, m: well above
/// the range noise and the error of the poses.
constexpr float kMargin = 0.07f;
/// How near another scan's point must be to confirm a place, m.
constexpr float kConfirms = 0.05f;
constexpr double kConfirmSpacing = 0.02;  // m: finer points confirm nothing more

// What stands among moving points and is confirmed by nobody moves with them: free space is told
// in cells of a degree, so the rim of a person against the wall behind gets no vote of its own.
constexpr int kGrowRounds = 4;
constexpr std::size_t kGrowNeighbours = 11;  // the point itself and 10 around it
constexpr std::size_t kGrowMajority = 6;
constexpr std::size_t kProbes = 256;  // points that tell whether two scans meet at all

enum class Vote : std::uint8_t { kNone, kMoving, kConfirmed };

struct Witness {
    const PlacedView* view;
    std::optional<DepthImage> image;  // where it has a viewpoint
    KdTree surface;
};

Witness make_witness(const PlacedView& view) {
    const std::vector<Vec3f>& positions = view.scan->points.positions;
    Witness witness{&view, std::nullopt, {}};
    std::vector<Vec3f> thinned;
    for (const std::uint32_t i : thin_indices(positions, kConfirmSpacing)) {
        thinned.push_back(positions[i]);
    }
    witness.surface = KdTree(thinned);
    if (!view.scan->has_viewpoint) return witness;
    const Vec3f place = vec3_cast<float>(-view.scan->offset);
    std::vector<Vec3f> seen = positions;
    for (Vec3f& p : seen)
        p -= place;
    witness.image.emplace(seen);
    return witness;
}

Vec3f transform(const Eigen::Isometry3f& T, const Vec3f& p) {
    const Eigen::Vector3f q = T * Eigen::Vector3f(p.x, p.y, p.z);
    return {q.x(), q.y(), q.z()};
}

/// What `witness` says of a place in its scan's frame.
Vote ask(const Witness& witness, const Vec3f& place) {
    if (witness.surface.nearest(place, kConfirms).found()) return Vote::kConfirmed;
    if (!witness.image) return Vote::kNone;
    const Vec3f viewpoint = vec3_cast<float>(-witness.view->scan->offset);
    return witness.image->at(place - viewpoint, kMargin) == Seen::kFree ? Vote::kMoving
                                                                        : Vote::kNone;
}

/// The scans that saw anything of where `view`'s points are.
std::vector<std::size_t> who_met(const PlacedView& view, std::span<const Witness> witnesses,
                                 std::span<const Eigen::Isometry3f> T_other_scan) {
    const std::vector<Vec3f>& positions = view.scan->points.positions;
    const std::size_t step = std::max<std::size_t>(1, positions.size() / kProbes);
    std::vector<std::size_t> met;
    for (std::size_t b = 0; b < witnesses.size(); ++b) {
        if (witnesses[b].view == &view) continue;
        for (std::size_t i = 0; i < positions.size(); i += step) {
            if (ask(witnesses[b], transform(T_other_scan[b], positions[i])) == Vote::kNone)
                continue;
            met.push_back(b);
            break;
        }
    }
    return met;
}

/// Lets moving points take over neighbours that nobody confirmed.
void grow(std::span<const Vec3f> positions, std::vector<Vote>& votes) {
    if (std::find(votes.begin(), votes.end(), Vote::kMoving) == votes.end()) return;
    const KdTree tree(positions);
    for (int round = 0; round < kGrowRounds; ++round) {
        const std::vector<Vote> before = votes;
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, votes.size(), 512),
                          [&](const auto& range) {
                              std::array<Neighbour, kGrowNeighbours> around;
                              for (std::size_t i = range.begin(); i < range.end(); ++i) {
                                  if (before[i] != Vote::kNone || !is_finite(positions[i]))
                                      continue;
                                  const std::size_t count = tree.nearest(positions[i], around);
                                  std::size_t moving = 0;
                                  for (std::size_t k = 0; k < count; ++k) {
                                      moving += before[around[k].index] == Vote::kMoving ? 1 : 0;
                                  }
                                  if (moving >= kGrowMajority) votes[i] = Vote::kMoving;
                              }
                          });
        if (votes == before) return;
    }
}

}  // namespace

std::vector<std::vector<std::uint32_t>> standing_points(std::span<const PlacedView> views) {
    std::vector<Witness> witnesses(views.size());
    tbb::parallel_for(std::size_t{0}, views.size(),
                      [&](std::size_t i) { witnesses[i] = make_witness(views[i]); });
    std::vector<std::vector<std::uint32_t>> standing(views.size());
    for (std::size_t a = 0; a < views.size(); ++a) {
        const std::vector<Vec3f>& positions = views[a].scan->points.positions;
        std::vector<Eigen::Isometry3f> T_other_scan;
        for (const PlacedView& other : views) {
            T_other_scan.push_back(
                (other.T_world_scan.inverse() * views[a].T_world_scan).cast<float>());
        }
        const std::vector<std::size_t> met = who_met(views[a], witnesses, T_other_scan);
        std::vector<Vote> votes(positions.size(), Vote::kNone);
        tbb::parallel_for(
            tbb::blocked_range<std::size_t>(0, positions.size(), 512), [&](const auto& range) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    if (!is_finite(positions[i])) continue;
                    for (const std::size_t b : met) {
                        const Vote vote =
                            ask(witnesses[b], transform(T_other_scan[b], positions[i]));
                        if (vote != Vote::kNone) votes[i] = vote;
                        if (vote == Vote::kConfirmed) break;
                    }
                }
            });
        grow(positions, votes);
        for (std::uint32_t i = 0; i < votes.size(); ++i) {
            if (votes[i] != Vote::kMoving && is_finite(positions[i])) standing[a].push_back(i);
        }
    }
    return standing;
}

}  // namespace glowworm
