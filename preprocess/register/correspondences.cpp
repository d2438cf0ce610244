#include "preprocess/register/correspondences.h"

#include <tbb/parallel_for.h>

#include <algorithm>

namespace glowworm {
namespace {

constexpr Eigen::Index kBlock = 256;

struct Candidate {
    float distance;
    std::uint32_t index;
    bool operator<(const Candidate& o) const {
        return distance != o.distance ? distance < o.distance : index < o.index;
    }
};

/// [from.size() * nearest] the most alike keypoints of `to` for each of `from`.
std::vector<Candidate> most_alike(const Keypoints& from, const Keypoints& to, std::size_t nearest) {
    const Eigen::VectorXf squares = to.descriptors.rowwise().squaredNorm();
    const Eigen::Index rows = from.descriptors.rows();
    std::vector<Candidate> best(from.size() * nearest);
    tbb::parallel_for(Eigen::Index{0}, (rows + kBlock - 1) / kBlock, [&](Eigen::Index block) {
        const Eigen::Index begin = block * kBlock, count = std::min(kBlock, rows - begin);
        // |a − b|² = |a|² − 2a·b + |b|²; |a|² does not change who is nearest.
        Eigen::MatrixXf distances =
            -2.0f * to.descriptors * from.descriptors.middleRows(begin, count).transpose();
        distances.colwise() += squares;
        for (Eigen::Index column = 0; column < count; ++column) {
            Candidate* own = &best[static_cast<std::size_t>(begin + column) * nearest];
            const float self = from.descriptors.row(begin + column).squaredNorm();
            std::fill(own, own + nearest, Candidate{std::numeric_limits<float>::infinity(), ~0u});
            const float* distance = distances.col(column).data();
            for (std::uint32_t row = 0; row < to.size(); ++row) {
                if (distance[row] >= own[nearest - 1].distance) continue;
                std::size_t place = nearest - 1;
                for (; place > 0 && distance[row] < own[place - 1].distance; --place) {
                    own[place] = own[place - 1];
                }
                own[place] = {distance[row], row};
            }
            for (std::size_t k = 0; k < nearest; ++k)
                own[k].distance += self;
        }
    });
    return best;
}

}  // namespace

std::vector<Correspondence> match(const Keypoints& source, const Keypoints& target,
                                  std::size_t nearest, std::size_t max_count) {
    std::vector<Correspondence> matches;
    if (source.size() == 0 || target.size() == 0) return matches;
    const std::vector<Candidate> forward = most_alike(source, target, nearest);
    const std::vector<Candidate> backward = most_alike(target, source, nearest);
    for (std::uint32_t s = 0; s < source.size(); ++s) {
        for (std::size_t k = 0; k < nearest; ++k) {
            const Candidate& candidate = forward[s * nearest + k];
            if (candidate.index >= target.size()) continue;
            const Candidate* back = &backward[candidate.index * nearest];
            const bool mutual =
                std::any_of(back, back + nearest, [&](const Candidate& c) { return c.index == s; });
            if (mutual) matches.push_back({s, candidate.index, candidate.distance});
        }
    }
    std::sort(matches.begin(), matches.end(), [](const Correspondence& a, const Correspondence& b) {
        if (a.distance != b.distance) return a.distance < b.distance;
        return a.source != b.source ? a.source < b.source : a.target < b.target;
    });
    if (matches.size() > max_count) matches.resize(max_count);
    return matches;
}

}  // namespace glowworm
