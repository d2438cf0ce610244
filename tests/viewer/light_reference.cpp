#include "light_reference.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

#include "octree/links.h"
#include "viewer/light/walls.h"

namespace glowworm::testing {

namespace {

constexpr double kMaxAlbedo = 0.99;

Vec3f normal_of(const Lobe& lobe) {
    return normalized(Vec3f{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]});
}

bool sees(const OctreeView& octree, const TraceSettings& trace, const Vec3f& from,
          const Vec3f& normal, float offset, const Vec3f& to, const ShadowTarget& target) {
    const Vec3f start = from + normal * offset;
    const Vec3f way = to - start;
    const float distance = length(way);
    const Ray ray{start, way / distance, normal,
                  std::min(0.5f * octree.grid.voxel_size(), 0.5f * distance), distance};
    return is_unoccluded(octree, trace, ray, target);
}

double falloff(const SpotLight& light, double cosine) {
    const double edge = std::cos(light.cone_deg * std::numbers::pi / 360.0);
    const double t = std::clamp((cosine - edge) / ((1.0 - edge) * light.blend), 0.0, 1.0);
    return std::max(cosine, 0.0) * t * t * (3.0 - 2.0 * t);
}

double spline_weight(double d, bool tricubic) {
    d = std::abs(d);
    if (!tricubic) return std::max(1.0 - d, 0.0);
    if (d >= 2.0) return 0.0;
    if (d >= 1.0) return (2.0 - d) * (2.0 - d) * (2.0 - d) / 6.0;
    return (4.0 - 6.0 * d * d + 3.0 * d * d * d) / 6.0;
}

/// Whether a lobe's plane, `wall` - 1, parts two points near it (light_lookup.glsl).
bool parts(const OctreeView& octree, std::uint32_t wall, const Vec3f& here, const Vec3f& there) {
    if (wall == 0) return false;
    const double edge = octree.grid.voxel_size();
    const Lobe& lobe = octree.lobes[wall - 1];
    const Vec3d middle{lobe.position[0], lobe.position[1], lobe.position[2]};
    const Vec3d n = vec3_cast<double>(normal_of(lobe));
    const Vec3d from = vec3_cast<double>(here) - middle, to = vec3_cast<double>(there) - middle;
    if (dot(n, to) > -0.35 * edge) return false;
    const double front = std::max(dot(n, from), 0.0);
    const Vec3d crossing = from + (to - from) * (front / (front - dot(n, to)));
    return length(crossing) < 2.0 * edge;
}

/// The leaf at a cell, nothing where it is empty.
const Node* find_leaf(const OctreeView& octree, int x, int y, int z) {
    const int depth = static_cast<int>(octree.grid.depth);
    if (x < 0 || y < 0 || z < 0 || x >> depth != 0 || y >> depth != 0 || z >> depth != 0) {
        return nullptr;
    }
    const Node* node = &octree.nodes[0];
    for (int shift = depth - 1; shift >= 0; --shift) {
        const unsigned octant =
            static_cast<unsigned>((x >> shift & 1) | (y >> shift & 1) << 1 | (z >> shift & 1) << 2);
        if ((node->mask >> octant & 1u) == 0) return nullptr;
        node = &octree.nodes[node->first + static_cast<std::uint32_t>(
                                               std::popcount(node->mask & ((1u << octant) - 1u)))];
    }
    return node;
}

}  // namespace

Vec3d direct_irradiance(const OctreeView& octree, const TraceSettings& trace, const Scene& scene,
                        const Vec3f& position, const Vec3f& normal, float offset,
                        int area_samples) {
    Vec3d sum;
    const Vec3d p = vec3_cast<double>(position) + octree.grid.origin;
    const Vec3d n = vec3_cast<double>(normal);
    const auto add_lamp = [&](const Vec3d& at, const Vec3f& intensity, auto&& shape) {
        const Vec3d way = at - p;
        const double distance = length(way);
        const double cosine = dot(n, way) / distance;
        if (cosine <= 0.0) return;
        const double strength = shape(way / distance) * cosine / (distance * distance);
        if (strength <= 0.0) return;
        const Vec3f to = vec3_cast<float>(at - octree.grid.origin);
        if (!sees(octree, trace, position, normal, offset, to, {})) return;
        sum += vec3_cast<double>(intensity) * strength;
    };
    for (const PointLight& light : scene.point_lights) {
        add_lamp(light.position, light.radiant_intensity, [](const Vec3d&) { return 1.0; });
    }
    for (const SpotLight& light : scene.spot_lights) {
        const Vec3d axis = normalized(light.direction);
        add_lamp(light.position, light.radiant_intensity,
                 [&](const Vec3d& way) { return falloff(light, -dot(way, axis)); });
    }
    for (std::size_t i = 0; i < scene.area_lights.size(); ++i) {
        const AreaLight& light = scene.area_lights[i];
        const Vec3d u = light.corners[1] - light.corners[0];
        const Vec3d v = light.corners[3] - light.corners[0];
        const Vec3d axis = light.normal();
        const ShadowTarget target{vec3_cast<float>(axis), static_cast<std::uint32_t>(i + 1)};
        for (int k = 0; k < area_samples * area_samples; ++k) {
            const Vec3d at = light.corners[0] + u * ((k % area_samples + 0.5) / area_samples) +
                             v * ((k / area_samples + 0.5) / area_samples);
            const Vec3d way = at - p;
            const double squared = dot(way, way);
            const double cosines = -dot(n, way) * dot(axis, way) / squared;
            if (dot(n, way) <= 0.0 || cosines <= 0.0) continue;
            const Vec3f to = vec3_cast<float>(at - octree.grid.origin);
            if (!sees(octree, trace, position, normal, offset, to, target)) continue;
            sum += vec3_cast<double>(light.radiance) *
                   (cosines / squared * length(cross(u, v)) / (area_samples * area_samples));
        }
    }
    return sum;
}

std::vector<LocalLight> bounce(const OctreeView& octree, std::span<const std::uint32_t> links,
                               std::uint32_t rays, std::span<const Vec3d> direct, int bounces) {
    std::vector<LocalLight> lights(octree.lobes.size());
    std::vector<Vec3d> radiance(octree.lobes.size());
    for (int k = 0; k < bounces; ++k) {
        for (std::size_t i = 0; i < radiance.size(); ++i) {
            const Lobe& lobe = octree.lobes[i];
            const double opening =
                std::min(1.0f, length(Vec3f{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]}));
            for (int c = 0; c < 3; ++c) {
                const double albedo = std::clamp<double>(lobe.albedo[c], 0.0, kMaxAlbedo);
                radiance[i][c] = albedo * opening / (1.0 - albedo * (1.0 - opening)) /
                                 std::numbers::pi * (direct[i][c] + lights[i].irradiance[c]);
            }
        }
        tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t i) {
            const Vec3f normal = normal_of(octree.lobes[i]);
            LocalLight sum;
            int valid = 0;
            for (std::uint32_t r = 0; r < rays; ++r) {
                const std::uint32_t link = links[i * rays + r];
                valid += link != kBuried;
                if (link >= kBuried) continue;
                const Vec3f way = link_direction(static_cast<std::uint32_t>(i), r, normal);
                const double cosine = dot(way, normal);
                const Vec3d tangent = vec3_cast<double>(way) - vec3_cast<double>(normal) * cosine;
                sum.irradiance += radiance[link];
                for (int c = 0; c < 3; ++c)
                    sum.turn[c] += tangent * (radiance[link][c] / std::max(cosine, 0.1));
            }
            const double share = std::numbers::pi / std::max(valid, 1);
            lights[i].irradiance = sum.irradiance * share;
            for (int c = 0; c < 3; ++c)
                lights[i].turn[c] = sum.turn[c] * share;
            lights[i].around = radiance[i] * std::numbers::pi;
        });
    }
    return lights;
}

LocalLight look_up(const OctreeView& octree, std::span<const LocalLight> lights,
                   const Vec3f& position, const Vec3f& normal, bool tricubic, double width,
                   std::uint32_t wall) {
    double at[3];
    int low[3], high[3];
    const double reach = (tricubic ? 2.0 : 1.0) * width;
    for (int a = 0; a < 3; ++a) {
        at[a] = static_cast<double>((position[a] - octree.grid.cube_min[a]) /
                                    octree.grid.voxel_size()) -
                0.5;
        low[a] = static_cast<int>(std::ceil(at[a] - reach));
        high[a] = static_cast<int>(std::floor(at[a] + reach));
    }
    LocalLight sum;
    double weights = 0.0;
    const Vec3d n = vec3_cast<double>(normal);
    for (int z = low[2]; z <= high[2]; ++z) {
        for (int y = low[1]; y <= high[1]; ++y) {
            for (int x = low[0]; x <= high[0]; ++x) {
                const Node* leaf = find_leaf(octree, x, y, z);
                if (leaf == nullptr) continue;
                const double w = spline_weight((x - at[0]) / width, tricubic) *
                                 spline_weight((y - at[1]) / width, tricubic) *
                                 spline_weight((z - at[2]) / width, tricubic);
                for (std::uint32_t i = leaf->first; i < leaf->first + (leaf->mask >> 8 & 3u); ++i) {
                    const Lobe& lobe = octree.lobes[i];
                    const Vec3d m = vec3_cast<double>(normal_of(lobe));
                    const double cosine = dot(n, m);
                    if (cosine <= 0.0) continue;
                    const Vec3f apart =
                        Vec3f{lobe.position[0], lobe.position[1], lobe.position[2]} - position;
                    const double height = dot(apart, normal) / octree.grid.voxel_size();
                    double weight = w * std::pow(cosine, 8.0) *
                                    std::exp(-4.0 * std::min(height * height, 16.0));
                    if (parts(octree, wall, position, position + apart) ||
                        parts(octree, lights[i].wall, position + apart, position)) {
                        weight *= 1e-5;
                    }
                    const Vec3d tilt = n - m * cosine;
                    for (int c = 0; c < 3; ++c) {
                        const double turned = 0.5 * (1.0 + cosine) * lights[i].irradiance[c] +
                                              dot(tilt, lights[i].turn[c]) +
                                              0.5 * (1.0 - cosine) * lights[i].around[c];
                        sum.irradiance[c] += weight * std::max(turned, 0.0);
                        sum.turn[c] += lights[i].turn[c] * weight;
                    }
                    weights += weight;
                }
            }
        }
    }
    if (weights <= 0.0) return {};
    sum.irradiance = sum.irradiance / weights;
    for (Vec3d& turn : sum.turn)
        turn = turn / weights;
    return sum;
}

std::vector<LocalLight> smooth(const OctreeView& octree, std::span<const LocalLight> rough) {
    std::vector<LocalLight> lights(rough.begin(), rough.end()), smoothed(lights.size());
    const std::vector<std::uint32_t> walls = walls_beside(octree);
    for (std::size_t i = 0; i < lights.size(); ++i)
        lights[i].wall = walls[i];
    tbb::parallel_for(std::size_t{0}, lights.size(), [&](std::size_t i) {
        const Lobe& lobe = octree.lobes[i];
        smoothed[i] =
            look_up(octree, lights, {lobe.position[0], lobe.position[1], lobe.position[2]},
                    normal_of(lobe), true, 2.0, walls[i]);
        smoothed[i].around = lights[i].around;
        smoothed[i].wall = walls[i];
    });
    return smoothed;
}

}  // namespace glowworm::testing
