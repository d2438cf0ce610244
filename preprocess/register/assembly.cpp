#include "preprocess/register/assembly.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace glowworm {
namespace {

constexpr double kMostContradicted = 0.04;  // over all pairs of two groups being joined
constexpr double kClosesWithin = 2.0;       // voxel sizes: a loop of a few pairs that closes
constexpr double kEdgeFloor = 0.004;        // voxel sizes: what sampling leaves even on good fits
constexpr double kLoopOverlap = 0.12;       // least overlap worth another edge
constexpr double kMostSigmas = 8.0;

using ScanPair = std::pair<std::size_t, std::size_t>;

ScanPair ordered(std::size_t a, std::size_t b) {
    return {std::min(a, b), std::max(a, b)};
}

/// T_a_b of each believed pair, both ways round.
std::map<ScanPair, Eigen::Isometry3d> relative_poses(std::span<const PairFit> pairs) {
    std::map<ScanPair, Eigen::Isometry3d> relative;
    for (const PairFit& pair : pairs) {
        if (!pair.believed) continue;
        relative[{pair.target, pair.source}] = pair.fit.T_target_source;
        relative[{pair.source, pair.target}] = pair.fit.T_target_source.inverse();
    }
    return relative;
}

/// Per pair the share of its triangles that close, 0.5 where it is part of none.
std::vector<double> closing_shares(std::span<const PairFit> pairs, const PairSettings& settings,
                                   std::size_t scans) {
    const std::map<ScanPair, Eigen::Isometry3d> relative = relative_poses(pairs);
    std::vector<double> shares(pairs.size());
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        const PairFit& pair = pairs[p];
        if (!pair.believed) continue;
        double close = 1.0, all = 2.0;
        for (std::size_t third = 0; third < scans; ++third) {
            const auto to_third = relative.find({third, pair.source});
            const auto from_third = relative.find({pair.target, third});
            if (to_third == relative.end() || from_third == relative.end()) continue;
            const Eigen::Isometry3d around = from_third->second * to_third->second;
            const Eigen::Isometry3d gap = around * pair.fit.T_target_source.inverse();
            all += 1.0;
            const double shift = (gap * pair.fit.centre - pair.fit.centre).norm();
            const double turn = Eigen::AngleAxisd(gap.rotation()).angle() * pair.fit.extent;
            if (shift + turn < kClosesWithin * settings.voxel_size) close += 1.0;
        }
        shares[p] = close / all;
    }
    return shares;
}

}  // namespace

Assembly apart(std::size_t scans) {
    Assembly assembly{.poses = {scans, Eigen::Isometry3d::Identity()},
                      .group = std::vector<std::size_t>(scans)};
    std::iota(assembly.group.begin(), assembly.group.end(), std::size_t{0});
    return assembly;
}

bool compatible(std::span<const ScanModel> models, const Assembly& assembly, std::size_t from,
                std::size_t to, const Eigen::Isometry3d& T_to_from, double voxel_size) {
    std::vector<ScanPair> across;
    for (std::size_t a = 0; a < models.size(); ++a) {
        if (assembly.group[a] != from) continue;
        for (std::size_t b = 0; b < models.size(); ++b) {
            if (assembly.group[b] == to) across.push_back({a, b});
        }
    }
    std::vector<Agreement> agreements(across.size());
    tbb::parallel_for(std::size_t{0}, across.size(), [&](std::size_t i) {
        const auto [a, b] = across[i];
        agreements[i] = verify(models[a], models[b],
                               assembly.poses[b].inverse() * T_to_from * assembly.poses[a],
                               1.5 * voxel_size, 500);
    });
    std::size_t against = 0, opinions = 0;
    for (const Agreement& a : agreements) {
        const std::size_t contradict = a.source_contradict + a.target_contradict;
        against += contradict;
        opinions += contradict + a.agree();
    }
    return static_cast<double>(against) <= kMostContradicted * static_cast<double>(opinions);
}

void assemble(std::span<const ScanModel> models, std::span<PairFit> pairs,
              const PairSettings& settings, Assembly& assembly) {
    const std::vector<double> closing = closing_shares(pairs, settings, models.size());
    std::vector<std::size_t> order(pairs.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    const auto evidence = [&](std::size_t p) {
        return closing[p] * pairs[p].agreement.best_overlap();
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return evidence(a) > evidence(b); });
    for (const std::size_t p : order) {
        PairFit& pair = pairs[p];
        if (!pair.believed) continue;
        const std::size_t from = assembly.group[pair.source], to = assembly.group[pair.target];
        if (from == to) continue;
        const Eigen::Isometry3d T = assembly.poses[pair.target] * pair.fit.T_target_source *
                                    assembly.poses[pair.source].inverse();
        if (!compatible(models, assembly, from, to, T, settings.voxel_size)) {
            pair.believed = false;
            continue;
        }
        // The group that keeps its frame is the one with the lower index.
        const std::size_t kept = std::min(from, to);
        const Eigen::Isometry3d motion = kept == to ? T : T.inverse();
        for (std::size_t i = 0; i < models.size(); ++i) {
            if (assembly.group[i] != std::max(from, to)) continue;
            assembly.poses[i] = motion * assembly.poses[i];
            assembly.group[i] = kept;
        }
    }
}

PoseEdge edge_of(const PairFit& pair, const PairSettings& settings) {
    return make_edge(pair.source, pair.target, pair.fit, kEdgeFloor * settings.voxel_size);
}

void settle(std::span<PairFit> pairs, const PairSettings& settings,
            std::span<const std::uint8_t> fixed, Assembly& assembly) {
    std::vector<std::uint8_t> held(fixed.begin(), fixed.end());
    for (std::size_t i = 0; i < held.size(); ++i) {
        bool any = false;
        for (std::size_t j = 0; j < held.size(); ++j) {
            any = any || (assembly.group[j] == assembly.group[i] && held[j]);
        }
        if (!any) held[i] = 1;
    }
    std::vector<std::size_t> used;
    for (std::size_t p = 0; p < pairs.size(); ++p) {
        pairs[p].accepted = false;
        if (pairs[p].believed &&
            assembly.group[pairs[p].source] == assembly.group[pairs[p].target]) {
            used.push_back(p);
        }
    }
    while (!used.empty()) {
        std::vector<PoseEdge> edges;
        for (const std::size_t p : used)
            edges.push_back(edge_of(pairs[p], settings));
        solve_pose_graph(assembly.poses, edges, held, settings.upright);
        double worst = 0.0;
        std::size_t where = 0;
        for (std::size_t e = 0; e < edges.size(); ++e) {
            const Misclosure gap = misclosure(edges[e], assembly.poses);
            const double distance =
                (gap.shift + gap.turn * edges[e].extent) / (kClosesWithin * settings.voxel_size);
            const double badness = std::min(distance, gap.sigmas / kMostSigmas);
            if (badness > worst) {
                worst = badness;
                where = e;
            }
        }
        if (worst <= 1.0) break;
        used.erase(used.begin() + static_cast<std::ptrdiff_t>(where));
    }
    for (const std::size_t p : used)
        pairs[p].accepted = true;
}

std::vector<PairFit> close_loops(std::span<const ScanModel> models, std::span<const PairFit> pairs,
                                 const PairSettings& settings, const Assembly& assembly) {
    std::vector<ScanPair> known;
    for (const PairFit& pair : pairs) {
        if (pair.believed) known.push_back(ordered(pair.source, pair.target));
    }
    std::sort(known.begin(), known.end());
    std::vector<ScanPair> open;
    for (std::size_t a = 0; a < models.size(); ++a) {
        for (std::size_t b = a + 1; b < models.size(); ++b) {
            if (assembly.group[a] != assembly.group[b]) continue;
            if (!std::binary_search(known.begin(), known.end(), ScanPair{a, b}))
                open.push_back({a, b});
        }
    }
    std::vector<PairFit> found(open.size());
    tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t i) {
        const auto [target, source] = open[i];
        const Eigen::Isometry3d start = assembly.poses[target].inverse() * assembly.poses[source];
        const Agreement near =
            verify(models[source], models[target], start, 2.0 * settings.voxel_size, 500);
        if (near.best_overlap() < kLoopOverlap) return;
        found[i] = align_from(models[source], models[target], start, settings);
        found[i].source = source;
        found[i].target = target;
    });
    std::erase_if(found, [](const PairFit& pair) { return !pair.believed; });
    return found;
}

}  // namespace glowworm
