#include "preprocess/register/verification.h"

#include <algorithm>

namespace glowworm {
namespace {

constexpr float kNormalsAgree = 0.5f;  // cosine
constexpr float kRangeMargin = 0.02f;  // of the range: what a small error in rotation shifts
constexpr double kAgainst = 8.0;       // how many agreeing samples one contradiction outweighs

void compare(const ScanModel& a, const ScanModel& b, const Eigen::Isometry3d& T_b_a,
             float tolerance, std::size_t max_samples, std::size_t& samples, std::size_t& agree,
             std::size_t& contradict) {
    const Eigen::Isometry3f T = T_b_a.cast<float>();
    const Eigen::Matrix3f R = T.linear();
    const std::size_t step = std::max<std::size_t>(1, a.coarse.size() / max_samples);
    for (std::size_t i = 0; i < a.coarse.size(); i += step) {
        ++samples;
        const Vec3f place = to_vec3(T * to_eigen(a.coarse.positions[i]));
        const Neighbour nearest = b.coarse.tree.nearest(place, tolerance);
        if (nearest.found()) {
            const Eigen::Vector3f n = R * to_eigen(a.coarse.normals[i]);
            if (n.dot(to_eigen(b.coarse.normals[nearest.index])) > kNormalsAgree) ++agree;
            continue;
        }
        if (!b.depths) continue;
        const Vec3f seen = place - b.viewpoint;
        if (b.depths->at(seen, tolerance + kRangeMargin * length(seen)) == Seen::kFree)
            ++contradict;
    }
}

double share(std::size_t part, std::size_t whole) {
    return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

double Agreement::overlap() const {
    return share(source_agree, source_samples);
}

double Agreement::best_overlap() const {
    return std::max(overlap(), share(target_agree, target_samples));
}

double Agreement::contradicted() const {
    const std::size_t against = source_contradict + target_contradict;
    return share(against, against + agree());
}

double Agreement::support() const {
    return best_overlap() - kAgainst * contradicted();
}

Agreement verify(const ScanModel& source, const ScanModel& target,
                 const Eigen::Isometry3d& T_target_source, double tolerance,
                 std::size_t max_samples) {
    Agreement result;
    const float t = static_cast<float>(tolerance);
    compare(source, target, T_target_source, t, max_samples, result.source_samples,
            result.source_agree, result.source_contradict);
    compare(target, source, T_target_source.inverse(), t, max_samples, result.target_samples,
            result.target_agree, result.target_contradict);
    return result;
}

}  // namespace glowworm
