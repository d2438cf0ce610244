#include "viewer/light/group_field.h"

#include <algorithm>

#include "viewer/light/bounce.h"

namespace glowworm {
namespace {

constexpr std::size_t kLobesAtOnce = 1 << 16;

}  // namespace

std::vector<gpu::vec4> GroupField::radiance(const Buffer& direct, const Buffer& indirect,
                                            std::span<const gpu::vec4> emitted) const {
    const std::size_t lobes = octree_.lobes.size();
    const auto of_groups = indirect.read<gpu::vec4>(count());
    std::vector<gpu::vec4> radiance(lobes);
    for (std::size_t first = 0; first < lobes; first += kLobesAtOnce) {
        const std::size_t here = std::min(kLobesAtOnce, lobes - first);
        const auto arriving = direct.read<gpu::vec4>(here, first);
        radiate(octree_.lobes.subspan(first, here),
                emitted.empty() ? emitted : emitted.subspan(first, here), arriving,
                std::span(groups().group_of).subspan(first, here), of_groups,
                std::span(radiance).subspan(first, here));
    }
    return radiance;
}

std::vector<gpu::vec4> GroupField::gather(const Buffer& direct, const Buffer& indirect,
                                          std::span<const gpu::vec4> emitted) {
    radiance_ = radiance(direct, indirect, emitted);
    std::vector<gpu::vec4> light(count());
    bounce_along(links_->rows(), radiance_, light);
    return light;
}

/// Lobes of one domain after the other lie side by side, and go to the GPU as they do.
void GroupField::publish(const Buffer& indirect, const gpu::LightGrid& grid,
                         std::span<const std::uint32_t> walls, bool smooth, Buffer& lit) const {
    const auto lights =
        group_gradients(*links_, octree_.lobes, radiance_, indirect.read<gpu::vec4>(count()));
    for (std::uint32_t coarser = 0; coarser <= LightDomains::kMostCoarser; ++coarser) {
        std::vector<std::uint32_t> lobes;
        auto spread = spread_to_lobes(octree_, *domains_, groups(), coarser, grid, lights,
                                      radiance_, smooth, lobes);
        for (std::size_t i = 0; i < lobes.size(); ++i)
            spread[i].irradiance.w = static_cast<float>(walls[lobes[i]]);
        for (std::size_t first = 0, last = 0; first < lobes.size(); first = last) {
            while (last < lobes.size() && lobes[last] - lobes[first] == last - first)
                ++last;
            lit.write(std::span<const gpu::LobeLight>(spread).subspan(first, last - first),
                      lobes[first]);
        }
    }
}

}  // namespace glowworm
