#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "preprocess/register/align.h"
#include "preprocess/register/assembly.h"

namespace glowworm {

/// The frame in which registration works: near its scans, so that doubles and floats are exact
/// enough, whatever the world's coordinates are.
struct LocalFrame {
    Vec3d origin;  ///< m, world: local = world − origin
    std::vector<std::optional<Eigen::Isometry3d>>
        given;                        ///< T_local_scan of its positions, where a pose is given
    std::vector<std::uint8_t> fixed;  ///< trusted poses
    bool all_given = false;           ///< and trusted
};

/// The given pose of model `i` (T_local_model), which must be there.
Eigen::Isometry3d given_pose(std::span<const ScanModel> models, const LocalFrame& frame,
                             std::size_t i);

/// Reads the given poses (settings.prior before the scans' own) unless they are to be ignored.
LocalFrame choose_frame(std::span<const Scan> scans, const RegistrationSettings& settings);

/// Every scan apart, trusted ones together where their poses put them.
Assembly start_assembly(std::span<const ScanModel> models, const LocalFrame& frame,
                        const RegistrationSettings& settings);

/// Pairs whose given poses let them see the same surface: refined from there, or, where both are
/// trusted, judged as they stand.
std::vector<PairFit> given_pairs(std::span<const ScanModel> models, const LocalFrame& frame,
                                 const PairSettings& pair_settings,
                                 const RegistrationSettings& settings);

}  // namespace glowworm
