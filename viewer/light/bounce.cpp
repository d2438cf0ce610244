#include "viewer/light/bounce.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>

#include "octree/links.h"
#include "viewer/gpu/vec4.h"

namespace glowworm {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kLeastCosine = 0.1f;  // light_gradient.comp
constexpr std::size_t kLobesPerTask = 512;

template <typename Visit>
void for_each_lobe(std::size_t lobes, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lobes, kLobesPerTask),
                      [&](const auto& range) {
                          for (std::size_t lobe = range.begin(); lobe != range.end(); ++lobe)
                              visit(lobe);
                      });
}

/// Of a row's rays, those that are not buried; at least 1.
float open_rays(std::span<const std::uint32_t> row) {
    const auto buried = std::ranges::count(row, kBuried);
    return static_cast<float>(std::max<std::ptrdiff_t>(std::ssize(row) - buried, 1));
}

}  // namespace

std::vector<gpu::vec4> bounce_along(const LinkRows& rows, std::span<const gpu::vec4> radiance) {
    // What meets nothing reads the black one at the end, without a branch.
    std::vector<gpu::vec4> sources(radiance.begin(), radiance.end());
    sources.emplace_back();
    const auto black = static_cast<std::uint32_t>(radiance.size());
    std::vector<gpu::vec4> gathered(rows.links.size() / std::max(rows.stride, 1u));
    for_each_lobe(gathered.size(), [&](std::size_t lobe) {
        const auto row = rows.of(lobe);
        gpu::vec4 sum{};
        for (const std::uint32_t link : row) {
            const gpu::vec4& from = sources[std::min(link, black)];
            sum.x += from.x;
            sum.y += from.y;
            sum.z += from.z;
            sum.w += from.w;
        }
        const float scale = kPi / open_rays(row);
        gathered[lobe] = {sum.x * scale, sum.y * scale, sum.z * scale, 0.0f};
    });
    return gathered;
}

std::vector<gpu::LobeLight> light_gradients(const LinkRows& rows, std::span<const Lobe> lobes,
                                            std::span<const gpu::vec4> radiance,
                                            std::span<const gpu::vec4> irradiance,
                                            std::span<const std::uint32_t> walls) {
    std::vector<gpu::LobeLight> lights(lobes.size());
    for_each_lobe(lobes.size(), [&](std::size_t lobe) {
        const auto row = rows.of(lobe);
        const float(&ndf)[3] = lobes[lobe].ndf;
        const Vec3f normal = normalized(Vec3f{ndf[0], ndf[1], ndf[2]});
        Vec3f turn[3];  // per channel
        for (std::uint32_t ray = 0; ray < rows.rays; ++ray) {
            if (row[ray] >= radiance.size()) continue;
            const Vec3f direction = link_direction(static_cast<std::uint32_t>(lobe), ray, normal);
            const float cosine = dot(direction, normal);
            const Vec3f along = (direction - cosine * normal) / std::max(cosine, kLeastCosine);
            const Vec3f from = to_vec3(radiance[row[ray]]);
            for (int c = 0; c < 3; ++c)
                turn[c] += along * from[c];
        }
        const float scale = kPi / open_rays(row);
        const Vec3f here = to_vec3(radiance[lobe]);
        gpu::LobeLight& light = lights[lobe];
        light.irradiance = {irradiance[lobe].x, irradiance[lobe].y, irradiance[lobe].z,
                            static_cast<float>(walls[lobe])};
        for (int c = 0; c < 3; ++c) {
            const Vec3f scaled = turn[c] * scale;
            light.turn[c] = {scaled.x, scaled.y, scaled.z, kPi * here[c]};
        }
    });
    return lights;
}

}  // namespace glowworm
