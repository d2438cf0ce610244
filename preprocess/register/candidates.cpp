#include "preprocess/register/candidates.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <set>

#include "preprocess/register/guesses.h"

namespace glowworm {
namespace {

using ScanPair = std::pair<std::size_t, std::size_t>;

constexpr std::size_t kFewPairs = 80;       // up to here all are tried
constexpr std::size_t kDistinctive = 3000;  // keypoints per scan that are compared
constexpr std::size_t kLooked = 40;         // guesses of each kind that are looked at
constexpr double kHopeless = -1e9;

/// Some of a scan's keypoints, and which they are.
struct Few {
    std::vector<std::uint32_t> indices;
    Keypoints keypoints;
};

/// The keypoints whose descriptors are farthest from the scan's mean: corners rather than walls.
Few most_distinctive(const Keypoints& all, std::size_t count) {
    std::vector<std::uint32_t> order(all.size());
    std::iota(order.begin(), order.end(), 0u);
    const Eigen::RowVectorXf mean = all.descriptors.colwise().mean();
    const Eigen::VectorXf distance = (all.descriptors.rowwise() - mean).rowwise().squaredNorm();
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return distance[static_cast<Eigen::Index>(a)] > distance[static_cast<Eigen::Index>(b)];
    });
    order.resize(std::min(order.size(), count));
    Few few{.indices = order, .keypoints = {}};
    few.keypoints.descriptors.resize(static_cast<Eigen::Index>(order.size()), 33);
    for (std::size_t i = 0; i < order.size(); ++i) {
        few.keypoints.positions.push_back(all.positions[order[i]]);
        few.keypoints.normals.push_back(all.normals[order[i]]);
        few.keypoints.descriptors.row(static_cast<Eigen::Index>(i)) =
            all.descriptors.row(static_cast<Eigen::Index>(order[i]));
    }
    return few;
}

/// The pairs that are among the best `per_scan` of either scan.
std::vector<ScanPair> promising(std::span<const ScanModel> models, std::span<const ScanPair> open,
                                const PairSettings& pair_settings, std::size_t per_scan) {
    std::vector<Few> few(models.size());
    tbb::parallel_for(std::size_t{0}, models.size(), [&](std::size_t i) {
        few[i] = most_distinctive(models[i].keypoints, kDistinctive);
    });
    std::vector<double> score(open.size(), kHopeless);
    tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t i) {
        const auto [target, source] = open[i];
        std::vector<Correspondence> matches =
            match(few[source].keypoints, few[target].keypoints, 3);
        for (Correspondence& match : matches) {
            match.source = few[source].indices[match.source];
            match.target = few[target].indices[match.target];
        }
        const std::vector<Guess> guesses = guess_poses(models[source], models[target], matches,
                                                       {.voxel_size = pair_settings.voxel_size,
                                                        .upright = pair_settings.upright,
                                                        .max_grown = kLooked,
                                                        .max_levelled = kLooked,
                                                        .max_count = 1});
        if (!guesses.empty()) score[i] = guesses[0].support;
    });
    std::vector<std::size_t> order(open.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return score[a] > score[b]; });
    std::vector<std::size_t> taken(models.size());
    std::set<ScanPair> chosen;
    for (const std::size_t i : order) {
        const auto [a, b] = open[i];
        if (taken[a] >= per_scan && taken[b] >= per_scan) continue;
        ++taken[a];
        ++taken[b];
        chosen.insert(open[i]);
    }
    return {chosen.begin(), chosen.end()};
}

}  // namespace

std::vector<ScanPair> candidate_pairs(std::span<const ScanModel> models,
                                      std::span<const PairFit> pairs, const Assembly& assembly,
                                      const PairSettings& pair_settings,
                                      const RegistrationSettings& settings) {
    std::set<ScanPair> believed;
    for (const PairFit& pair : pairs) {
        if (pair.believed) believed.insert(std::minmax(pair.source, pair.target));
    }
    std::vector<ScanPair> open;
    const auto consider = [&](std::size_t a, std::size_t b) {
        const ScanPair pair = std::minmax(a, b);
        if (pair.first == pair.second || pair.second >= models.size()) return;
        if (believed.contains(pair) || assembly.group[a] == assembly.group[b]) return;
        if (models[a].keypoints.size() == 0 || models[b].keypoints.size() == 0) return;
        open.push_back(pair);
    };
    for (const auto& [a, b] : settings.pairs)
        consider(a, b);
    if (!settings.pairs.empty()) return open;
    for (std::size_t a = 0; a < models.size(); ++a) {
        for (std::size_t b = a + 1; b < models.size(); ++b)
            consider(a, b);
    }
    if (open.size() <= kFewPairs) return open;
    return promising(models, open, pair_settings, settings.candidates_per_scan);
}

}  // namespace glowworm
