#include "viewer/light/upload.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

#include "octree/close_patches.h"
#include "octree/error.h"
#include "octree/pack.h"

namespace glowworm {

namespace {

gpu::vec4 to_vec4(const Vec3f& v, float w = 0.0f) {
    return {v.x, v.y, v.z, w};
}

Vec3f relative(const Vec3d& world, const OctreeView& octree) {
    return vec3_cast<float>(world - octree.grid.origin);
}

Vec3d corner_of(const AreaLightRecord& record, std::size_t corner) {
    return {record.corners[3 * corner], record.corners[3 * corner + 1],
            record.corners[3 * corner + 2]};
}

std::string_view name_of(const AreaLightRecord& record, const OctreeView& octree) {
    if (record.name_offset > octree.names.size()) return {};
    return octree.names.substr(record.name_offset, record.name_bytes);
}

/// 1 + the octree's area light that is `light`, 0 where it has none.
std::uint32_t tag_of(const AreaLight& light, const OctreeView& octree) {
    const double near = 0.5 * static_cast<double>(octree.grid.voxel_size());
    for (std::size_t i = 0; i < octree.area_lights.size(); ++i) {
        const AreaLightRecord& record = octree.area_lights[i];
        bool same = !light.name.empty() && name_of(record, octree) == light.name;
        if (!same) {
            same = true;
            for (std::size_t c = 0; c < 4; ++c) {
                same &= length(corner_of(record, c) - light.corners[c]) < near;
            }
        }
        if (same) return static_cast<std::uint32_t>(i + 1);
    }
    return 0;
}

/// Whether `point` (m, relative) lies on the rectangle of `light`, to within `near` metres.
bool lies_on(const AreaLight& light, const OctreeView& octree, const Vec3f& point, float near) {
    const Vec3f corner = relative(light.corners[0], octree);
    const Vec3f u = relative(light.corners[1], octree) - corner;
    const Vec3f v = relative(light.corners[3], octree) - corner;
    const Vec3f at = point - corner;
    const float along_u = dot(at, normalized(u));
    const float along_v = dot(at, normalized(v));
    return std::abs(dot(at, vec3_cast<float>(light.normal()))) <= near && along_u >= -near &&
           along_u <= length(u) + near && along_v >= -near && along_v <= length(v) + near;
}

bool is_bindable(const Context& context, std::size_t bytes) {
    return bytes <= static_cast<std::size_t>(context.device().max_storage_bytes);
}

void check_binding(const Context& context, const char* what, std::size_t bytes) {
    if (is_bindable(context, bytes)) return;
    throw Error(
        ExitCode::kBudget,
        fmt::format("the octree's {} take {:.0f} MiB and this OpenGL shows at most {:.0f} MiB at "
                    "once: simulate light at a coarser level with --light-depth",
                    what, static_cast<double>(bytes) / (1 << 20),
                    static_cast<double>(context.device().max_storage_bytes) / (1 << 20)));
}

}  // namespace

std::uint64_t light_bytes(std::uint64_t nodes, std::uint64_t lobes, const LightSettings& settings) {
    constexpr std::uint64_t kSideBytes = 8;                   // halves, cones.cpp
    constexpr std::uint64_t kFields = 5 * sizeof(gpu::vec4);  // emitted to gathered, light_field.h
    constexpr std::uint64_t kLit = 2 * sizeof(gpu::LobeLight);  // before and after smoothing
    constexpr std::uint64_t kHistory = 4 * (sizeof(float) + sizeof(gpu::vec4));  // anderson.h
    const bool cones = settings.gather == Gather::kCones || settings.faithful;
    const std::uint64_t of_node = sizeof(Node) + (cones ? 6 * kSideBytes : 0);
    const std::uint64_t of_lobe = sizeof(Lobe) + kFields + kLit + kHistory +
                                  (cones ? 0 : settings.links * sizeof(std::uint32_t));
    return nodes * of_node + lobes * of_lobe;
}

std::uint64_t grouped_light_bytes(std::uint64_t nodes, std::uint64_t lobes, std::uint64_t groups,
                                  const LightSettings& settings) {
    constexpr std::uint64_t kOfLobe = sizeof(Lobe) + sizeof(gpu::LobeLight) +
                                      2 * sizeof(gpu::vec4) +     // direct, radiance
                                      4 * sizeof(std::uint32_t);  // its wall; in LightGroups
    constexpr std::uint64_t kHistory = 4 * (sizeof(float) + sizeof(gpu::vec4));  // anderson.h
    const std::uint64_t of_group = 2 * sizeof(gpu::vec4) + kHistory + sizeof(Lobe) +
                                   2 * sizeof(gpu::LobeLight) +
                                   (settings.links + 1) * sizeof(std::uint32_t);  // and its wall
    return nodes * sizeof(Node) + lobes * kOfLobe + groups * of_group;
}

bool runs_compiled(const Context& context, const LightSettings& settings) {
    return context.device().software && settings.run_on != RunOn::kGpu;
}

bool fits_shaders(const Context& context, const OctreeView& octree) {
    return is_bindable(context, octree.nodes.size_bytes()) &&
           is_bindable(context,
                       octree.lobes.size() * std::max(sizeof(Lobe), sizeof(gpu::LobeLight)));
}

LightGround make_light_ground(const OctreeView& octree, const TraceSettings& settings,
                              bool with_tracer) {
    LightGround ground{close_patches(octree), nullptr};
    if (!with_tracer) return ground;
    OctreeView closed = octree;
    closed.lobes = ground.closed;
    ground.tracer = std::make_shared<RayTracer>(closed, settings);
    return ground;
}

GpuOctree upload(const Context& context, const OctreeView& octree, std::span<const Lobe> closed,
                 const LightSettings& settings) {
    const bool cones = settings.gather == Gather::kCones || settings.faithful;
    if (cones || !runs_compiled(context, settings)) {
        check_binding(context, "nodes", octree.nodes.size_bytes());
        check_binding(context, "lobes", octree.lobes.size_bytes());
    }
    GpuOctree uploaded;
    uploaded.nodes = Buffer::of("octree nodes", octree.nodes);
    uploaded.lobes = Buffer::of("octree lobes", closed);
    uploaded.grid = {
        .cube_min_x = octree.grid.cube_min.x,
        .cube_min_y = octree.grid.cube_min.y,
        .cube_min_z = octree.grid.cube_min.z,
        .voxel_size = octree.grid.voxel_size(),
        .depth = octree.grid.depth,
        .lobe_count = static_cast<std::uint32_t>(octree.lobes.size()),
        .light_count = 0,
        .flags = (settings.tricubic ? LIGHT_FLAG_TRICUBIC : 0u) |
                 (settings.faithful ? LIGHT_FLAG_FAITHFUL : 0u),
        .patch_margin = settings.trace.patch_margin,
        .reach = settings.trace.reach,
        .cube_edge = octree.grid.cube_edge,
        .links_per_lobe = settings.links,
    };
    return uploaded;
}

std::vector<gpu::Light> lights_for_gpu(const Scene& scene, const OctreeView& octree,
                                       bool faithful) {
    std::vector<gpu::Light> lights;
    for (const PointLight& light : scene.point_lights) {
        gpu::Light& to = lights.emplace_back();
        to.kind = LIGHT_POINT;
        to.position = to_vec4(relative(light.position, octree));
        to.intensity = to_vec4(light.radiant_intensity);
    }
    for (const SpotLight& light : scene.spot_lights) {
        const double half_angle = 0.5 * light.cone_deg * std::numbers::pi / 180.0;
        gpu::Light& to = lights.emplace_back();
        to.kind = LIGHT_SPOT;
        to.position = to_vec4(relative(light.position, octree));
        to.intensity = to_vec4(light.radiant_intensity);
        to.axis = to_vec4(vec3_cast<float>(normalized(light.direction)),
                          static_cast<float>(std::cos(half_angle)));
        to.edge_u.w = static_cast<float>(light.blend);
    }
    if (faithful) return lights;
    for (const AreaLight& light : scene.area_lights) {
        gpu::Light& to = lights.emplace_back();
        to.kind = LIGHT_AREA;
        to.tag = tag_of(light, octree);
        to.position = to_vec4(relative(light.corners[0], octree));
        to.intensity = to_vec4(light.radiance);
        to.axis = to_vec4(vec3_cast<float>(light.normal()));
        to.edge_u = to_vec4(vec3_cast<float>(light.corners[1] - light.corners[0]));
        to.edge_v = to_vec4(vec3_cast<float>(light.corners[3] - light.corners[0]));
    }
    return lights;
}

std::vector<gpu::vec4> emitted_radiance(const Scene& scene, const OctreeView& octree,
                                        bool faithful) {
    std::vector<Vec3f> of_tag(octree.area_lights.size() + 1);  // what the scene says of each
    for (const AreaLight& light : scene.area_lights)
        of_tag[tag_of(light, octree)] = light.radiance;
    const float near = octree.grid.voxel_size();

    std::vector<gpu::vec4> emitted(octree.lobes.size());
    for (std::size_t i = 0; i < emitted.size(); ++i) {
        const Lobe& lobe = octree.lobes[i];
        if (lobe.light != 0) {
            if (faithful && lobe.light < of_tag.size()) emitted[i] = to_vec4(of_tag[lobe.light]);
            continue;
        }
        if (lobe.emission == 0) continue;
        const Vec3f position = to_vec3(lobe.position);
        const bool of_scene = std::ranges::any_of(scene.area_lights, [&](const AreaLight& light) {
            return lies_on(light, octree, position, near);
        });
        if (faithful || !of_scene) emitted[i] = to_vec4(unpack_rgb9e5(lobe.emission));
    }
    return emitted;
}

}  // namespace glowworm
