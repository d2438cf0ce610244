#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "preprocess/register/pairwise.h"

namespace glowworm {

/// Scans put together as far as they hold: those of one group lie in one frame.
struct Assembly {
    std::vector<Eigen::Isometry3d> poses;  ///< [scans] T_group_scan
    std::vector<std::size_t> group;        ///< [scans] the lowest index of its group
};

/// Every scan by itself.
Assembly apart(std::size_t scans);

/// Whether the scans of two groups leave each other's free space alone once `T_to_from` has moved
/// the group `from` into the frame of the group `to`.
bool compatible(std::span<const ScanModel> models, const Assembly& assembly, std::size_t from,
                std::size_t to, const Eigen::Isometry3d& T_to_from, double voxel_size);

/// Joins groups along believed pairs, best evidence first: the share of closing triangles a pair is
/// part of, then overlap. A pair joins two groups only where none of their scans, in their joint
/// positions, see through each other; otherwise it loses its belief.
void assemble(std::span<const ScanModel> models, std::span<PairFit> pairs,
              const PairSettings& settings, Assembly& assembly);

/// Accepts the believed pairs within groups that close and moves all scans to where these agree
/// (pose graph); the pair that is farthest from closing is given up until all close. Scans with
/// `fixed` stay, and one of each group stays that has no fixed one.
void settle(std::span<PairFit> pairs, const PairSettings& settings,
            std::span<const std::uint8_t> fixed, Assembly& assembly);

/// Pairs within a group that see the same surface by now and are not among `pairs` yet, refined
/// from where they lie: these close loops.
std::vector<PairFit> close_loops(std::span<const ScanModel> models, std::span<const PairFit> pairs,
                                 const PairSettings& settings, const Assembly& assembly);

/// The pose graph edge of a pair.
PoseEdge edge_of(const PairFit& pair, const PairSettings& settings);

}  // namespace glowworm
