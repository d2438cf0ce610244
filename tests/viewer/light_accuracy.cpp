#include "light_accuracy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "octree/build.h"
#include "viewer/light/light_field.h"
#include "viewer/light/light_meter.h"

namespace glowworm::testing {

namespace {

constexpr double kSphereRadius = 2.0;  // m
constexpr double kIntensity = 10.0;    // W/sr
constexpr double kPointsPerFace = 4.0;
constexpr std::size_t kPlaces = 4000;
constexpr std::uint64_t kSeed = 1;

Octree octree_of(const SurfelCloud& cloud, std::uint32_t depth) {
    BuildSettings settings;
    settings.depth = depth;
    return build_octree(cloud, settings);
}

/// m: the edge that leaves of a scene will have.
double leaf_edge(const PanelScene& scene, std::uint32_t depth) {
    Vec3d low = scene.panels[0].corner, high = low;
    for (const Panel& panel : scene.panels) {
        for (int k = 0; k < 4; ++k) {
            low = component_min(low, panel.at(k & 1, k >> 1));
            high = component_max(high, panel.at(k & 1, k >> 1));
        }
    }
    const Vec3d size = high - low;
    return std::ldexp(std::max({size.x, size.y, size.z}) * 33.0 / 32.0, -static_cast<int>(depth));
}

Octree octree_of(const PanelScene& scene, std::uint32_t depth) {
    const double edge = leaf_edge(scene, depth);
    const double count = kPointsPerFace * area_of(scene) / (edge * edge);
    return octree_of(scatter_surfels(scene, static_cast<std::size_t>(count), kSeed), depth);
}

/// Reflected light at places, by the light meter.
std::vector<double> measure(const LightField& field, const std::vector<PanelPoint>& places) {
    std::vector<Probe> probes;
    for (const PanelPoint& place : places)
        probes.push_back({place.position, vec3_cast<float>(place.normal)});
    std::vector<double> irradiance;
    for (const ProbeResult& result : measure_light(field, probes))
        irradiance.push_back(static_cast<double>(result.indirect.x));
    return irradiance;
}

std::vector<double> errors_of_parts(const KnownLight& known, const std::vector<double>& measured) {
    std::vector<double> means(known.settled.size()), places(known.settled.size());
    for (std::size_t i = 0; i < measured.size(); ++i) {
        means[known.part[i]] += measured[i];
        places[known.part[i]] += 1.0;
    }
    for (std::size_t part = 0; part < means.size(); ++part)
        means[part] /= places[part] * known.settled[part];
    for (double& mean : means)
        mean -= 1.0;
    return means;
}

KnownLight known_light(const PanelScene& scene, std::size_t parts, std::size_t photons,
                       const PartOf& part_of) {
    KnownLight known{scene,
                     scatter(scene, kPlaces, kSeed, true),
                     {},
                     photon_traced(scene, parts, part_of, photons, kSeed)};
    for (const PanelPoint& place : known.places)
        known.part.push_back(part_of(place));
    return known;
}

/// m to the nearest edge of its panel.
double from_edge(const Panel& panel, const Vec3d& position) {
    const Vec3d at = position - panel.corner;
    const double u = dot(at, normalized(panel.u)), v = dot(at, normalized(panel.v));
    return std::min({u, v, length(panel.u) - u, length(panel.v) - v});
}

}  // namespace

SurfelCloud sphere(std::size_t count, float albedo, bool even) {
    SurfelCloud cloud;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    // Independent places come from a square that is folded onto the sphere (Archimedes).
    const PanelScene square{.panels = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    const auto places = scatter(square, even ? 0 : count, kSeed, false);
    for (std::size_t i = 0; i < count; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
        const double z = 1.0 - 2.0 * (even ? share : places[i].position.x);
        const double angle =
            even ? golden * static_cast<double>(i) : 2.0 * std::numbers::pi * places[i].position.y;
        const double r = std::sqrt(1.0 - z * z);
        const Vec3d n{r * std::cos(angle), r * std::sin(angle), z};
        Surfel& surfel = cloud.surfels.emplace_back();
        surfel.position = vec3_cast<float>(n * kSphereRadius);
        surfel.normal = vec3_cast<float>(-n);
        if (even) {
            surfel.radius =
                static_cast<float>(2.0 * kSphereRadius / std::sqrt(static_cast<double>(count)));
        }
        surfel.albedo = {albedo, albedo, albedo};
    }
    return cloud;
}

SphereAccuracy sphere_accuracy(const Context& context, const LightSettings& settings,
                               std::uint32_t depth, float albedo, double off_centre,
                               double points_per_face) {
    const double leaves_along = std::ldexp(32.0 / 33.0, static_cast<int>(depth));
    const double faces = std::numbers::pi * leaves_along * leaves_along;
    const bool even = points_per_face <= 0.0;
    const double count = faces * (even ? 10.0 / 3.0 : points_per_face);
    const Octree octree = octree_of(sphere(static_cast<std::size_t>(count), albedo, even), depth);
    Scene scene;
    const auto power = static_cast<float>(kIntensity);
    scene.point_lights.push_back({"lamp", {off_centre, 0.0, 0.0}, {power, power, power}});
    LightField field(context, octree.view(), scene, settings);
    const Convergence convergence = field.converge();

    const auto rho = static_cast<double>(albedo);
    const double truth = kIntensity / (kSphereRadius * kSphereRadius) * rho / (1.0 - rho);
    SphereAccuracy accuracy{.bounces = convergence.bounces, .settled = convergence.settled};
    const auto indirect = field.read_indirect();
    const auto lobes = static_cast<double>(indirect.size());
    for (const gpu::vec4& e : indirect) {
        const double error = static_cast<double>(e.x) / truth - 1.0;
        accuracy.mean += error / lobes;
        accuracy.rms += error * error / lobes;
        accuracy.worst = std::max(accuracy.worst, std::abs(error));
    }
    accuracy.rms = std::sqrt(accuracy.rms);
    return accuracy;
}

KnownLight known_cube(double albedo, std::size_t photons) {
    PanelScene scene{.panels = box_panels({0, 0, 0}, {2, 2, 2}), .albedo = albedo};
    scene.panels[0].emission = 1.0;
    return known_light(turned(scene), 6, photons,
                       [](const PanelPoint& place) { return place.panel; });
}

CubeAccuracy cube_accuracy(const Context& context, const LightSettings& settings,
                           std::uint32_t depth, const KnownLight& cube) {
    const Octree octree = octree_of(cube.scene, depth);
    LightField field(context, octree.view(), {}, settings);
    field.iterate(1);
    const auto once = measure(field, cube.places);
    const double interior = 2.0 * static_cast<double>(octree.grid.voxel_size());
    CubeAccuracy accuracy;
    double truth = 0.0, squares = 0.0, emitting = 0.0, inside = 0.0;
    for (std::size_t i = 0; i < once.size(); ++i) {
        const PanelPoint& place = cube.places[i];
        if (from_edge(cube.scene.panels[place.panel], place.position) < interior) continue;
        if (place.panel == 0) {
            accuracy.emitter += once[i] / std::numbers::pi;
            emitting += 1.0;
            continue;
        }
        const double known = irradiance_from(cube.scene.panels[0], place.position, place.normal);
        const double error = once[i] - known;
        truth += known;
        accuracy.bias += error;
        squares += error * error;
        inside += 1.0;
    }
    accuracy.bias /= truth;
    accuracy.nrms = std::sqrt(squares * inside) / truth;
    accuracy.emitter /= emitting;

    field.converge();
    const auto error = errors_of_parts(cube, measure(field, cube.places));
    std::ranges::copy(error, accuracy.walls);
    return accuracy;
}

KnownLight known_tunnel(double albedo, std::size_t photons) {
    const PanelScene straight = two_bend_tunnel(albedo);
    const PanelScene scene = turned(straight);
    return known_light(scene, 7, photons, [&](const PanelPoint& place) {
        const Panel& here = scene.panels[place.panel];
        const Vec3d at = place.position - here.corner;
        const Vec3d unturned = straight.panels[place.panel].at(
            dot(at, here.u) / dot(here.u, here.u), dot(at, here.v) / dot(here.v, here.v));
        return std::min<std::size_t>(6, static_cast<std::size_t>(0.7 * along_tunnel(unturned)));
    });
}

std::vector<double> tunnel_accuracy(const Context& context, const LightSettings& settings,
                                    std::uint32_t depth, const KnownLight& tunnel) {
    const Octree octree = octree_of(tunnel.scene, depth);
    LightField field(context, octree.view(), lamps_of(tunnel.scene), settings);
    field.converge();
    return errors_of_parts(tunnel, measure(field, tunnel.places));
}

int bounces_to_far_end(const Context& context, const LightSettings& settings, std::uint32_t depth,
                       const KnownLight& tunnel) {
    constexpr int kMost = 60, kQuiet = 6;
    const Octree octree = octree_of(tunnel.scene, depth);
    LightField field(context, octree.view(), lamps_of(tunnel.scene), settings);
    std::vector<PanelPoint> places;
    for (std::size_t i = 0; i < tunnel.places.size(); ++i) {
        if (tunnel.part[i] == 6) places.push_back(tunnel.places[i]);
    }
    const auto far_end = [&] {
        const auto measured = measure(field, places);
        return std::accumulate(measured.begin(), measured.end(), 0.0);
    };
    field.converge(1e-6);
    const double settled = far_end();
    int needed = 1;
    for (int bounces = 1; bounces < kMost && bounces < needed + kQuiet; ++bounces) {
        field.forget_indirect();
        field.converge(0.0, bounces);
        if (std::abs(far_end() / settled - 1.0) > 0.01) needed = bounces + 1;
    }
    return needed;
}

WallLeak wall_leak(const Context& context, const LightSettings& settings, std::uint32_t depth,
                   double voxels) {
    const auto rooms = [](double wall) {
        PanelScene scene{.panels = box_panels({0, 0, 0}, {1, 1, 1}), .albedo = 0.5};
        for (const Panel& panel : box_panels({1 + wall, 0, 0}, {2 + wall, 1, 1}))
            scene.panels.push_back(panel);
        scene.lamps.push_back({"lamp", {0.5, 0.5, 0.5}, {10.0f, 10.0f, 10.0f}});
        return turned(scene);
    };
    const double wall = voxels * leaf_edge(rooms(0.0), depth);
    const PanelScene scene = rooms(wall);
    const Octree octree = octree_of(scene, depth);
    LightField field(context, octree.view(), lamps_of(scene), settings);
    field.converge();

    const auto share = [](const double(&rooms_light)[2]) {
        return rooms_light[1] / rooms_light[0];
    };
    double on_lobes[2] = {}, on_meter[2] = {};
    const auto indirect = field.read_indirect();
    const Panel& first_wall = scene.panels[0];
    for (std::size_t i = 0; i < indirect.size(); ++i) {
        const Lobe& lobe = octree.lobes[i];
        const Vec3d at =
            octree.grid.origin + Vec3d{lobe.position[0], lobe.position[1], lobe.position[2]};
        const bool dark = dot(first_wall.normal(), at - first_wall.corner) > 1.0 + 0.5 * wall;
        on_lobes[dark] += static_cast<double>(lobe.area * indirect[i].x);
    }
    const auto places = scatter(scene, kPlaces, kSeed, true);
    const auto measured = measure(field, places);
    for (std::size_t i = 0; i < places.size(); ++i)
        on_meter[places[i].panel >= 6] += measured[i];
    return {share(on_lobes), share(on_meter)};
}

}  // namespace glowworm::testing
