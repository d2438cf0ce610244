#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "octree/scene.h"
#include "octree/surfel.h"

namespace glowworm::testing {

/// A rectangle lit from the side that u x v points to.
struct Panel {
    Vec3d corner, u, v;     ///< m; u and v at right angles
    double emission = 0.0;  ///< W·sr⁻¹·m⁻²

    Vec3d normal() const { return normalized(cross(u, v)); }
    double area() const { return length(u) * length(v); }
    Vec3d at(double along_u, double along_v) const { return corner + along_u * u + along_v * v; }
};

/// A closed cave of diffuse rectangles: its shape is known exactly, and so is its light.
struct PanelScene {
    std::vector<Panel> panels;
    double albedo = 0.5;
    std::vector<PointLight> lamps;
};

/// The inside of a box, panels in the order -x +x -y +y -z +z. `outward`: its outside instead.
std::vector<Panel> box_panels(const Vec3d& low, const Vec3d& high, bool outward = false);

/// Two bends in a passage of 1 x 1 m: 3.5, 3 and 3.5 m along its middle. A lamp of 10 W/sr stands
/// half a metre before its first end.
PanelScene two_bend_tunnel(double albedo);

/// Metres along the middle of two_bend_tunnel, 0..10, next to a point.
double along_tunnel(const Vec3d& point);

/// The scene turned so that no wall lies along the grid.
PanelScene turned(const PanelScene& scene);
Vec3d turned(const Vec3d& v);

/// A place on a panel.
struct PanelPoint {
    Vec3d position, normal;
    std::size_t panel = 0;
};

/// `count` places by area: independent of each other, or evenly spread (the R2 sequence).
std::vector<PanelPoint> scatter(const PanelScene& scene, std::size_t count, std::uint64_t seed,
                                bool even);

/// Independent places as surfels without radii, as raw clouds come.
SurfelCloud scatter_surfels(const PanelScene& scene, std::size_t count, std::uint64_t seed);

double area_of(const PanelScene& scene);
Scene lamps_of(const PanelScene& scene);

/// Irradiance that an evenly emitting panel, wholly above the horizon and unhidden, gives: the form
/// factor of a polygon (Lambert 1760).
double irradiance_from(const Panel& panel, const Vec3d& position, const Vec3d& normal);

/// Which part of the scene a place belongs to.
using PartOf = std::function<std::size_t(const PanelPoint&)>;

/// [parts] mean irradiance, W·m⁻², by tracing photons: what panels emit, and what was reflected at
/// least once of the lamps' light.
std::vector<double> photon_traced(const PanelScene& scene, std::size_t parts, const PartOf& part_of,
                                  std::size_t photons, std::uint64_t seed);

}  // namespace glowworm::testing
