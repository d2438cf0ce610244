#include "viewer/light/bounce.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>

#include "viewer/light/irradiance_turn.h"

namespace glowworm {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr std::size_t kLobesPerTask = 512;

template <typename Visit>
void for_each_lobe(std::size_t lobes, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lobes, kLobesPerTask),
                      [&](const auto& range) {
                          for (std::size_t lobe = range.begin(); lobe != range.end(); ++lobe)
                              visit(lobe);
                      });
}

}  // namespace

float open_rays(std::span<const std::uint32_t> row) {
    const auto buried = std::ranges::count(row, kBuried);
    return static_cast<float>(std::max<std::ptrdiff_t>(std::ssize(row) - buried, 1));
}

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
        const Vec3f normal = normalized(to_vec3(lobes[lobe].ndf));
        IrradianceTurn turn;
        for (std::uint32_t ray = 0; ray < rows.rays; ++ray) {
            if (row[ray] < radiance.size())
                turn.add(static_cast<std::uint32_t>(lobe), ray, normal, radiance[row[ray]]);
        }
        lights[lobe] =
            turn.light(irradiance[lobe], walls[lobe], open_rays(row), to_vec3(radiance[lobe]));
    });
    return lights;
}

}  // namespace glowworm
