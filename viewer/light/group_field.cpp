#include "viewer/light/group_field.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "viewer/light/bounce.h"
#include "viewer/light/walls.h"

namespace glowworm {
namespace {

constexpr std::size_t kLobesAtOnce = 1 << 16;

}  // namespace

GroupField::GroupField(const OctreeView& octree, const LightDomains& domains,
                       const GroupLinks& links)
    : octree_(octree),
      domains_(&domains),
      links_(&links),
      walls_(octree.lobes.size()),
      has_walls_(domains.count()) {}

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

void GroupField::find_walls() {
    std::vector<LobeRange> missing;
    for (std::size_t d = 0; d < has_walls_.size(); ++d) {
        if (groups().shown[d] == 0 || has_walls_[d] != 0) continue;
        missing.push_back({domains_->first_lobe_of(d), domains_->first_lobe_of(d + 1)});
        has_walls_[d] = 1;
    }
    if (!missing.empty()) find_walls_beside(octree_, missing, walls_);
}

std::vector<gpu::LobeLight> GroupField::light(const Buffer& indirect, const gpu::LightGrid& grid,
                                              bool smooth) {
    find_walls();
    const auto lights =
        group_gradients(*links_, octree_.lobes, radiance_, indirect.read<gpu::vec4>(count()));
    std::vector<gpu::LobeLight> lit(octree_.lobes.size());
    tbb::parallel_for(std::size_t{0}, domains_->count(), [&](std::size_t d) {
        if (groups().shown[d] != 0) return;
        for (std::uint32_t lobe = domains_->first_lobe_of(d); lobe < domains_->first_lobe_of(d + 1);
             ++lobe) {
            lit[lobe] = lights[groups().group_of[lobe]];
            lit[lobe].irradiance.w = 0.0f;
        }
    });
    for (std::uint32_t coarser = 0; coarser <= LightDomains::kMostCoarser; ++coarser) {
        std::vector<std::uint32_t> lobes;
        const auto spread = spread_to_lobes(octree_, *domains_, groups(), coarser, grid, lights,
                                            radiance_, smooth, lobes);
        for (std::size_t i = 0; i < lobes.size(); ++i) {
            lit[lobes[i]] = spread[i];
            lit[lobes[i]].irradiance.w = static_cast<float>(walls_[lobes[i]]);
        }
    }
    return lit;
}

}  // namespace glowworm
