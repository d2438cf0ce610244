#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "octree/progress.h"
#include "octree/surfel.h"
#include "preprocess/surface/neighbours.h"
#include "preprocess/surface/plane_fit.h"
#include "preprocess/surface/point_tree.h"

namespace glowworm {

/// The plane that the surface follows at one point.
struct LocalPlane {
    Vec3f normal;            ///< unit; zero: the point is isolated
    float height = 0.0f;     ///< m: of the plane over the point, along the normal
    float thickness = 0.0f;  ///< m: rms distance of the neighbours, 3 fitted numbers allowed for
    float error_per_noise =
        0.0f;                  ///< 1/m: times the range noise (m): standard error of the angle, rad
    float area = 0.0f;         ///< m² of surface that the point stands for
    std::uint16_t points = 0;  ///< fitted, the point itself among them
    bool edge = false;         ///< only one side of an edge was fitted
};

/// Everything about the points that the fits look at, in tree order.
struct SurfacePoints {
    PointTree tree;
    std::vector<std::uint32_t> stations;   ///< [n] index of a station; empty: all of station 0
    std::vector<std::uint32_t> seen_from;  ///< [n] index into `viewpoints`; empty: as `stations`
    std::vector<Vec3f> viewpoints;         ///< m, relative to the cloud's origin; stations first
    std::vector<bool> has_viewpoint;       ///< as long as `viewpoints`

    std::size_t size() const { return tree.size(); }
    std::uint32_t station(std::size_t i) const { return stations.empty() ? 0 : stations[i]; }
    std::uint32_t view(std::size_t i) const {
        return seen_from.empty() ? station(i) : seen_from[i];
    }
    bool is_viewed(std::size_t i) const {
        return view(i) < viewpoints.size() && has_viewpoint[view(i)];
    }
    /// From point i toward where it was seen from, m; only where is_viewed(i).
    Vec3f toward_viewpoint(std::size_t i) const { return viewpoints[view(i)] - tree.position(i); }
};

struct NormalSettings {
    int k = 16;
    int max_k = 64;
    float radius = 1.0f;        ///< m
    float range_noise = 0.0f;   ///< m
    float slope_error = 0.04f;  ///< rad
};

/// The nearest of the neighbours, which later steps look at again: [n x count] in tree order,
/// filled up with kNoNeighbour.
struct NeighbourTable {
    int count = 0;
    std::vector<std::uint32_t> rows;

    /// The neighbours of point i.
    std::span<const std::uint32_t> of(std::size_t i) const {
        const auto stride = static_cast<std::size_t>(count);
        const std::uint32_t* row = rows.data() + i * stride;
        std::size_t found = stride;
        while (found > 0 && row[found - 1] == kNoNeighbour)
            --found;
        return {row, found};
    }
};

/// m² that each of the points of `fit` stands for when they are its nearest n and lie at random:
/// the ellipse through them, with the bias of few points taken out.
double area_per_point(const PlaneFit& fit);

/// Fits a plane to the neighbourhood of every point. Neighbours that another station saw from the
/// plane's other side are of another surface (the far side of a curtain) and left out. `table` gets
/// the nearest of the neighbours. In parallel.
std::vector<LocalPlane> fit_local_planes(const SurfacePoints& points,
                                         const NormalSettings& settings, NeighbourTable& table,
                                         const Progress& progress);

/// Fits anew where the thickness says that the neighbourhood crosses an edge: to the points of the
/// face that the point lies in, weighted by their distance from it (Tukey's biweight); where noise
/// leaves open which of two faces that is, to their mean, weighted by how likely either is. Returns
/// how many were. In parallel.
std::size_t sharpen_edges(const SurfacePoints& points, const NormalSettings& settings,
                          std::vector<LocalPlane>& planes);

}  // namespace glowworm
