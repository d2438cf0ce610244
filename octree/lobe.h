#pragma once

#include <array>
#include <cstdint>

#include "octree/node_layout.h"
#include "octree/vec3.h"

namespace glowworm {

/// Most lobes a leaf may have: two of the surface and one that emits.
inline constexpr std::size_t kMaxLobes = 3;

/// What is splatted into a leaf: a piece of surface.
struct LobeSample {
    Vec3d position;            ///< m, relative to the grid's origin, inside the leaf
    Vec3d ndf;                 ///< normal times Toksvig length
    Vec3d albedo;              ///< linear
    Vec3d emission;            ///< W·sr⁻¹·m⁻²
    double area = 0.0;         ///< m²
    double surfels = 1.0;      ///< how many surfels it stands for; a piece of a disc is a fraction
    double plane_sigma = 0.0;  ///< m: spread along its own normal
    std::uint32_t light = 0;   ///< 0 or 1 + index of the area light it belongs to

    bool emits() const {
        return light != 0 || emission.x > 0.0 || emission.y > 0.0 || emission.z > 0.0;
    }
};

/// Pieces of one surfel in a leaf: lengths in leaf edges from the leaf's centre.
struct PieceMoments {
    double share = 0.0;  ///< of the surfel, 0..1
    Vec3d mean;
    double products[6] = {};  ///< means of xx, yy, zz, xy, xz, yz
    Vec3d lower, upper;
};

/// Area-weighted sums of samples, lengths in leaf edges from the leaf's centre.
struct LobeSums {
    double area = 0.0, surfels = 0.0;
    Vec3d position, ndf, albedo, emission;
    double moments[6] = {};  ///< xx, yy, zz, xy, xz, yz of position
    Vec3d lower, upper;
    std::uint32_t light = 0;

    void operator+=(const LobeSums& other);
};

/// One leaf while its samples arrive. Samples fall into six classes by the dominant axis of their
/// normal, and those that emit into a seventh; `finish` joins the classes into lobes. One pass and
/// constant memory, however many samples a leaf has.
struct LeafSums {
    Vec3d centre;            ///< m, relative to the grid's origin
    double edge = 0.0;       ///< m
    std::uint32_t used = 0;  ///< bit per class
    std::array<LobeSums, 7> classes;

    /// Empties the leaf and places it.
    void begin(const Vec3d& cell_min, double cell_edge);
    void add(const LobeSample& sample);
    /// Adds a finer leaf's lobe whose patch spans `lower` to `upper` (m).
    void add_box(const LobeSample& sample, const Vec3d& lower, const Vec3d& upper);
    /// Adds pieces of a surfel at once: the area and number of `sample` are of all of them
    /// together, its position is not looked at.
    void add_pieces(const LobeSample& sample, const PieceMoments& pieces);

    /// Writes one to three lobes, the surface's first, the larger one first, and returns how many.
    /// The surface is split in two where mean normals lie more than 60° apart.
    std::size_t finish(std::array<Lobe, kMaxLobes>& lobes) const;

  private:
    void add_sums(const LobeSample& sample, const LobeSums& piece);
};

}  // namespace glowworm
