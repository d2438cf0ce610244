#include "panel_scene.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace glowworm::testing {

namespace {

constexpr double kOffSurface = 1e-9;  // m
constexpr std::size_t kPlacesForArea = 1 << 20;
constexpr double kR2U = 0.7548776662466927, kR2V = 0.5698402909980532;  // Roberts 2018

/// SplitMix64 (Steele et al. 2014).
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    /// In [0, 1).
    double operator()() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1p-53;
    }

  private:
    std::uint64_t state_;
};

struct PanelHit {
    const Panel* panel = nullptr;
    double t = 0.0;  ///< m
};

/// The first panel in the way, `direction` unit.
PanelHit first_hit(const PanelScene& scene, const Vec3d& origin, const Vec3d& direction) {
    PanelHit hit{nullptr, std::numeric_limits<double>::max()};
    for (const Panel& panel : scene.panels) {
        const Vec3d n = cross(panel.u, panel.v);
        const double slope = dot(n, direction);
        const double t = dot(n, panel.corner - origin) / slope;
        if (!(t > kOffSurface && t < hit.t)) continue;
        const Vec3d at = origin + direction * t - panel.corner;
        const double u = dot(at, panel.u) / dot(panel.u, panel.u);
        const double v = dot(at, panel.v) / dot(panel.v, panel.v);
        if (u >= 0.0 && u <= 1.0 && v >= 0.0 && v <= 1.0) hit = {&panel, t};
    }
    return hit;
}

Vec3d cosine_direction(const Panel& panel, Random& random) {
    const double sine_squared = random();
    const double angle = 2.0 * std::numbers::pi * random();
    return std::sqrt(sine_squared) *
               (std::cos(angle) * normalized(panel.u) + std::sin(angle) * normalized(panel.v)) +
           std::sqrt(1.0 - sine_squared) * panel.normal();
}

/// A photon leaves the scene's lights, each chosen by its power.
struct Photon {
    Vec3d position, direction;
    bool from_lamp = false;  ///< its first hit is direct light
};

double power_of(const Panel& panel) {
    return std::numbers::pi * panel.emission * panel.area();
}

double power_of(const PointLight& lamp) {
    return 4.0 * std::numbers::pi * static_cast<double>(lamp.radiant_intensity.x);
}

double power_of(const PanelScene& scene) {
    double sum = 0.0;
    for (const PointLight& lamp : scene.lamps)
        sum += power_of(lamp);
    for (const Panel& panel : scene.panels)
        sum += power_of(panel);
    return sum;
}

Photon emitted(const PanelScene& scene, double total_power, Random& random) {
    double rest = random() * total_power;
    for (const PointLight& lamp : scene.lamps) {
        rest -= power_of(lamp);
        if (rest > 0.0) continue;
        const double z = 2.0 * random() - 1.0, angle = 2.0 * std::numbers::pi * random();
        const double r = std::sqrt(1.0 - z * z);
        return {lamp.position, {r * std::cos(angle), r * std::sin(angle), z}, true};
    }
    const Panel* from = nullptr;
    for (const Panel& panel : scene.panels) {
        if (panel.emission <= 0.0) continue;
        from = &panel;
        rest -= power_of(panel);
        if (rest <= 0.0) break;
    }
    const double u = random();
    return {from->at(u, random()), cosine_direction(*from, random)};
}

}  // namespace

std::vector<Panel> box_panels(const Vec3d& low, const Vec3d& high, bool outward) {
    std::vector<Panel> panels;
    for (int axis = 0; axis < 3; ++axis) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        Vec3d u, v;
        u[b] = high[b] - low[b];
        v[c] = high[c] - low[c];
        Vec3d far = low;
        far[axis] = high[axis];
        panels.push_back(outward ? Panel{low, v, u} : Panel{low, u, v});
        panels.push_back(outward ? Panel{far, u, v} : Panel{far, v, u});
    }
    return panels;
}

PanelScene two_bend_tunnel(double albedo) {
    PanelScene scene{.albedo = albedo};
    const auto add = [&](const Vec3d& corner, const Vec3d& u, const Vec3d& v) {
        scene.panels.push_back({corner, u, v});
    };
    const Vec3d up{0, 0, 1};
    const double legs[3][4] = {{0, 0, 4, 1}, {3, 1, 1, 3}, {4, 3, 3, 1}};
    for (const auto& [x, y, wide, deep] : legs) {
        add({x, y, 0}, {wide, 0, 0}, {0, deep, 0});
        add({x, y, 1}, {0, deep, 0}, {wide, 0, 0});
    }
    add({0, 0, 0}, up, {4, 0, 0});  // seen along +y
    add({4, 3, 0}, up, {3, 0, 0});
    add({0, 1, 0}, {3, 0, 0}, up);  // along -y
    add({3, 4, 0}, {4, 0, 0}, up);
    add({0, 0, 0}, {0, 1, 0}, up);  // along +x
    add({3, 1, 0}, {0, 3, 0}, up);
    add({4, 0, 0}, up, {0, 3, 0});  // along -x
    add({7, 3, 0}, up, {0, 1, 0});
    scene.lamps.push_back({"lamp", {0.5, 0.5, 0.5}, {10.0f, 10.0f, 10.0f}});
    return scene;
}

double along_tunnel(const Vec3d& p) {
    const double legs[3] = {std::clamp(p.x, 0.0, 3.5), std::clamp(p.y, 0.5, 3.5),
                            std::clamp(p.x, 3.5, 7.0)};
    const double away[3] = {std::hypot(p.x - legs[0], p.y - 0.5),
                            std::hypot(p.x - 3.5, p.y - legs[1]),
                            std::hypot(p.x - legs[2], p.y - 3.5)};
    const double along[3] = {legs[0], 3.0 + legs[1], 3.0 + legs[2]};
    return along[std::min_element(away, away + 3) - away];
}

Vec3d turned(const Vec3d& v) {
    const double a[3] = {0.4, 0.7, 0.23};  // radians round x, y, z
    Vec3d p = v;
    for (int axis = 0; axis < 3; ++axis) {
        const int b = (axis + 1) % 3, c = (axis + 2) % 3;
        const double x = p[b], y = p[c];
        p[b] = std::cos(a[axis]) * x - std::sin(a[axis]) * y;
        p[c] = std::sin(a[axis]) * x + std::cos(a[axis]) * y;
    }
    return p;
}

PanelScene turned(const PanelScene& scene) {
    PanelScene result = scene;
    for (Panel& panel : result.panels)
        panel = {turned(panel.corner), turned(panel.u), turned(panel.v), panel.emission};
    for (PointLight& lamp : result.lamps)
        lamp.position = turned(lamp.position);
    return result;
}

double area_of(const PanelScene& scene) {
    double sum = 0.0;
    for (const Panel& panel : scene.panels)
        sum += panel.area();
    return sum;
}

std::vector<PanelPoint> scatter(const PanelScene& scene, std::size_t count, std::uint64_t seed,
                                bool even) {
    Random random(seed);
    const double area = area_of(scene);
    std::vector<PanelPoint> places(count);
    for (std::size_t i = 0; i < count; ++i) {
        PanelPoint& place = places[i];
        const double k = static_cast<double>(i) + 0.5;
        double rest = area * (even ? k / static_cast<double>(count) : random());
        while (place.panel + 1 < scene.panels.size() && rest >= scene.panels[place.panel].area())
            rest -= scene.panels[place.panel++].area();
        const Panel& panel = scene.panels[place.panel];
        const double u = even ? std::fmod(k * kR2U, 1.0) : random();
        place.position = panel.at(u, even ? std::fmod(k * kR2V, 1.0) : random());
        place.normal = panel.normal();
    }
    return places;
}

SurfelCloud scatter_surfels(const PanelScene& scene, std::size_t count, std::uint64_t seed) {
    SurfelCloud cloud;
    const auto albedo = static_cast<float>(scene.albedo);
    for (const PanelPoint& place : scatter(scene, count, seed, false)) {
        Surfel& surfel = cloud.surfels.emplace_back();
        surfel.position = vec3_cast<float>(place.position);
        surfel.normal = vec3_cast<float>(place.normal);
        const auto emission = static_cast<float>(scene.panels[place.panel].emission);
        surfel.emission = {emission, emission, emission};
        surfel.albedo = {albedo, albedo, albedo};
    }
    return cloud;
}

Scene lamps_of(const PanelScene& scene) {
    Scene lit;
    lit.point_lights = scene.lamps;
    return lit;
}

double irradiance_from(const Panel& panel, const Vec3d& position, const Vec3d& normal) {
    const Vec3d corners[4] = {panel.at(0, 0), panel.at(0, 1), panel.at(1, 1), panel.at(1, 0)};
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
        const Vec3d a = normalized(corners[i] - position);
        const Vec3d b = normalized(corners[(i + 1) % 4] - position);
        const Vec3d edge = cross(a, b);
        sum += std::atan2(length(edge), dot(a, b)) * dot(normalized(edge), normal);
    }
    return 0.5 * panel.emission * std::abs(sum);
}

std::vector<double> photon_traced(const PanelScene& scene, std::size_t parts, const PartOf& part_of,
                                  std::size_t photons, std::uint64_t seed) {
    constexpr std::size_t kBlocks = 64;  // summed in order: the same on any number of threads
    const double total_power = power_of(scene);
    std::vector<std::vector<double>> hits(kBlocks, std::vector<double>(parts));
    tbb::parallel_for(std::size_t{0}, kBlocks, [&](std::size_t block) {
        Random random((seed * kBlocks + block) * 0xd1342543de82ef95u);
        for (std::size_t i = 0; i < photons / kBlocks; ++i) {
            Photon photon = emitted(scene, total_power, random);
            for (bool direct = photon.from_lamp;; direct = false) {
                const PanelHit hit = first_hit(scene, photon.position, photon.direction);
                if (hit.panel == nullptr || dot(hit.panel->normal(), photon.direction) > 0.0) break;
                photon.position += photon.direction * hit.t;
                const auto panel = static_cast<std::size_t>(hit.panel - scene.panels.data());
                if (!direct) hits[block][part_of({photon.position, {}, panel})] += 1.0;
                if (random() >= scene.albedo) break;
                photon.direction = cosine_direction(*hit.panel, random);
            }
        }
    });
    std::vector<double> irradiance(parts), shares(parts);
    for (const PanelPoint& place : scatter(scene, kPlacesForArea, seed, true))
        shares[part_of(place)] += 1.0 / static_cast<double>(kPlacesForArea);
    const double traced = static_cast<double>(photons / kBlocks * kBlocks);
    for (std::size_t part = 0; part < parts; ++part) {
        for (const auto& of_block : hits)
            irradiance[part] += of_block[part];
        irradiance[part] *= total_power / traced / (shares[part] * area_of(scene));
    }
    return irradiance;
}

}  // namespace glowworm::testing
