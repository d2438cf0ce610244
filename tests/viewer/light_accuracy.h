#pragma once

#include <cstdint>
#include <vector>

#include "octree/surfel.h"
#include "panel_scene.h"
#include "viewer/gpu/context.h"
#include "viewer/light/settings.h"

namespace glowworm::testing {

/// How near reflected light comes to what is known of simple closed caves. Errors are relative, so
/// 0.01 is 1 %. Points lie independent of each other, as raw clouds' do, four a voxel face unless
/// said otherwise, and walls turned against the grid.

/// The inside of a sphere of 2 m round the origin: evenly covered (a Fibonacci lattice), or by
/// points independent of each other, whose radii are left to the build.
SurfelCloud sphere(std::size_t count, float albedo, bool even = true);

/// Over all lobes, against E_indirect = flux / (4 pi R²) albedo / (1 - albedo).
struct SphereAccuracy {
    double mean = 0.0, rms = 0.0, worst = 0.0;
    int bounces = 0;
    bool settled = false;
};
/// The lamp stands `off_centre` metres off. `points_per_face`: 0 for an even ten thirds.
SphereAccuracy sphere_accuracy(const Context& context, const LightSettings& settings,
                               std::uint32_t depth, float albedo, double off_centre,
                               double points_per_face = 0.0);

/// A cave, places spread over it, and the light that truly arrives there.
struct KnownLight {
    PanelScene scene;
    std::vector<PanelPoint> places;
    std::vector<std::size_t> part;  ///< of each place: wall of the cube, section of the tunnel
    std::vector<double> settled;    ///< [parts] W·m⁻², mean over each, by tracing photons
};

/// A cube of 2 m whose first wall emits.
KnownLight known_cube(double albedo, std::size_t photons);

/// By the light meter. Errors after one bounce are of places on the five other walls at least two
/// leaf edges off the cube's edges, as shares of the mean that form factors give.
struct CubeAccuracy {
    double bias = 0.0, nrms = 0.0;
    double emitter = 0.0;  ///< what the emitter gets after one bounce, of pi times its radiance
    double walls[6] = {};  ///< once settled, error of each wall's mean; 0 is the emitter
};
CubeAccuracy cube_accuracy(const Context& context, const LightSettings& settings,
                           std::uint32_t depth, const KnownLight& cube);

/// A tunnel with two bends in seven sections, the lit one first.
KnownLight known_tunnel(double albedo, std::size_t photons);

/// Error of each section's mean once settled.
std::vector<double> tunnel_accuracy(const Context& context, const LightSettings& settings,
                                    std::uint32_t depth, const KnownLight& tunnel);

/// Bounces until the last section stays within 1 % of what it settles at.
int bounces_to_far_end(const Context& context, const LightSettings& settings, std::uint32_t depth,
                       const KnownLight& tunnel);

/// Two rooms of 1 m with a wall of `voxels` leaf edges between and a lamp in one. What the dark
/// room has of the lit one's light, by area: on lobes, and by the light meter, which reads between
/// them.
struct WallLeak {
    double lobes = 0.0, meter = 0.0;
};
WallLeak wall_leak(const Context& context, const LightSettings& settings, std::uint32_t depth,
                   double voxels);

}  // namespace glowworm::testing
