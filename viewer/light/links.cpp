#include "viewer/light/links.h"

#include <algorithm>

#include "octree/links.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::uint32_t kRaysAtOnce = 16;  // a dispatch stays short enough for a display's GPU

}  // namespace

GpuLinks::GpuLinks(const Context& context, const OctreeView& octree, const LightSettings& settings,
                   const Progress& progress)
    : rays_(std::clamp(settings.links, 1u, 1024u)),
      lobes_(static_cast<std::uint32_t>(octree.lobes.size())),
      bounce_({"bounce.comp"}) {
    const std::size_t row_bytes = rays_ * sizeof(std::uint32_t);
    const std::size_t most = static_cast<std::size_t>(context.device().max_storage_bytes);
    const std::size_t lobes_per_block = std::max<std::size_t>(1, most / row_bytes);
    for (std::size_t first = 0; first < lobes_; first += lobes_per_block) {
        const std::size_t last = std::min<std::size_t>(lobes_, first + lobes_per_block);
        blocks_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
                           Buffer("links", (last - first) * row_bytes)});
    }

    const bool baked = octree.links_per_lobe >= rays_ && !octree.links.empty();
    const bool on_gpu = settings.trace_on == TraceOn::kGpu ||
                        (settings.trace_on == TraceOn::kFaster && !context.device().software);
    if (!baked && on_gpu) {
        trace(progress);
        return;
    }
    std::vector<std::uint32_t> traced;
    std::uint32_t stride = octree.links_per_lobe;
    std::span<const std::uint32_t> links = octree.links;
    if (!baked) {
        traced = trace_links(octree, {.rays = rays_, .trace = settings.trace}, progress);
        links = traced;
        stride = rays_;
    }
    for (Block& block : blocks_) {
        if (stride == rays_) {
            block.links.write(
                links.subspan(std::size_t{block.first_lobe} * stride,
                              std::size_t{block.last_lobe - block.first_lobe} * stride));
            continue;
        }
        for (std::uint32_t lobe = block.first_lobe; lobe < block.last_lobe; ++lobe) {
            block.links.write(links.subspan(std::size_t{lobe} * stride, rays_),
                              std::size_t{lobe - block.first_lobe} * rays_);
        }
    }
}

void GpuLinks::trace(const Progress& progress) {
    const Program program({"trace_links.comp"});
    for (const Block& block : blocks_) {
        block.links.bind_storage(BINDING_LINKS);
        set_uniform(program, 0, block.first_lobe);
        set_uniform(program, 1, block.last_lobe);
        for (std::uint32_t ray = 0; ray < rays_; ray += kRaysAtOnce) {
            if (progress) progress(block.first_lobe, lobes_);
            set_uniform(program, 2, ray);
            set_uniform(program, 3, std::min(rays_, ray + kRaysAtOnce));
            program.dispatch(block.last_lobe - block.first_lobe, kGroup);
        }
    }
    if (progress) progress(lobes_, lobes_);
}

void GpuLinks::gather() const {
    over_blocks(bounce_);
}

void GpuLinks::over_blocks(const Program& pass) const {
    set_uniform(pass, 2, rays_);
    for (const Block& block : blocks_) {
        block.links.bind_storage(BINDING_LINKS);
        set_uniform(pass, 0, block.first_lobe);
        set_uniform(pass, 1, block.last_lobe);
        pass.dispatch(block.last_lobe - block.first_lobe, kGroup);
    }
}

std::vector<std::uint32_t> GpuLinks::read() const {
    std::vector<std::uint32_t> all;
    for (const Block& block : blocks_) {
        const auto links = block.links.read<std::uint32_t>(
            std::size_t{block.last_lobe - block.first_lobe} * rays_);
        all.insert(all.end(), links.begin(), links.end());
    }
    return all;
}

}  // namespace glowworm
