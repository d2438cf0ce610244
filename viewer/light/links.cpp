#include "viewer/light/links.h"

#include <algorithm>
#include <utility>

#include "octree/links.h"

namespace glowworm {

namespace {

constexpr std::size_t kGroup = 64;
constexpr std::uint32_t kRaysAtOnce = 16;  // a dispatch stays short enough for a display's GPU

}  // namespace

GpuLinks::GpuLinks(const Context& context, const OctreeView& octree, const LightSettings& settings,
                   const Progress& progress, std::uint32_t first_rays,
                   std::shared_ptr<const RayTracer> tracer)
    : lobes_(static_cast<std::uint32_t>(octree.lobes.size())),
      all_rays_(std::clamp(settings.links, 1u, kMostLinks)) {
    rows_.rays = all_rays_;
    const bool baked = octree.links_per_lobe >= rows_.rays && !octree.links.empty();
    const bool software = context.device().software;
    const bool on_gpu =
        settings.run_on == RunOn::kGpu || (settings.run_on == RunOn::kFaster && !software);
    if (on_gpu) {
        bounce_ = Program({"bounce.comp"});
        make_blocks(context);
        if (!baked) {
            trace({0, std::min(first_rays, all_rays_)}, progress);
            return;
        }
    }
    if (!baked) {
        traced_ = trace_links(octree, {.rays = rows_.rays, .trace = settings.trace}, progress,
                              std::move(tracer));
    }
    rows_.links = baked ? octree.links : traced_;
    rows_.stride = baked ? octree.links_per_lobe : rows_.rays;
    if (!on_gpu) return;
    upload();
    rows_.links = {};
}

GpuLinks::GpuLinks(const LinkRows& rows)
    : lobes_(static_cast<std::uint32_t>(rows.links.size() / std::max(rows.stride, 1u))),
      all_rays_(rows.rays),
      rows_(rows) {}

bool GpuLinks::trace_more(const Progress& progress) {
    if (rows_.rays >= all_rays_) return false;
    trace({rows_.rays, std::min(2 * rows_.rays, all_rays_)}, progress);
    return true;
}

void GpuLinks::make_blocks(const Context& context) {
    const std::size_t row_bytes = all_rays_ * sizeof(std::uint32_t);
    const auto most = static_cast<std::size_t>(context.device().max_storage_bytes);
    const std::size_t lobes_per_block = std::max<std::size_t>(1, most / row_bytes);
    for (std::size_t first = 0; first < lobes_; first += lobes_per_block) {
        const std::size_t last = std::min<std::size_t>(lobes_, first + lobes_per_block);
        blocks_.push_back({static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last),
                           Buffer("links", (last - first) * row_bytes)});
    }
}

void GpuLinks::upload() {
    for (Block& block : blocks_) {
        for (std::uint32_t lobe = block.first_lobe; lobe < block.last_lobe; ++lobe)
            block.links.write(rows_.of(lobe), std::size_t{lobe - block.first_lobe} * all_rays_);
    }
}

void GpuLinks::trace(Rays rays, const Progress& progress) {
    const Program program({"trace_links.comp"});
    for (const Block& block : blocks_) {
        block.links.bind_storage(BINDING_LINKS);
        set_uniform(program, 0, block.first_lobe);
        set_uniform(program, 1, block.last_lobe);
        for (std::uint32_t ray = rays.first; ray < rays.last; ray += kRaysAtOnce) {
            if (progress) progress(block.first_lobe, lobes_);
            set_uniform(program, 2, ray);
            set_uniform(program, 3, std::min(rays.last, ray + kRaysAtOnce));
            program.dispatch(block.last_lobe - block.first_lobe, kGroup);
        }
    }
    rows_.rays = rays.last;
    if (progress) progress(lobes_, lobes_);
}

void GpuLinks::gather(const Buffer& radiance, Buffer& gathered) const {
    if (on_cpu()) {
        std::vector<gpu::vec4> light(lobes_);
        bounce_along(rows_, radiance.read<gpu::vec4>(lobes_), light);
        gathered.write(light);
    } else {
        over_blocks(bounce_);
    }
}

void GpuLinks::over_blocks(const Program& pass) const {
    set_uniform(pass, 2, rows_.rays);
    for (const Block& block : blocks_) {
        block.links.bind_storage(BINDING_LINKS);
        set_uniform(pass, 0, block.first_lobe);
        set_uniform(pass, 1, block.last_lobe);
        pass.dispatch(block.last_lobe - block.first_lobe, kGroup);
    }
}

std::vector<std::uint32_t> GpuLinks::read() const {
    std::vector<std::uint32_t> all;
    for (std::uint32_t lobe = 0; on_cpu() && lobe < lobes_; ++lobe)
        all.insert(all.end(), rows_.of(lobe).begin(), rows_.of(lobe).end());
    for (const Block& block : blocks_) {
        const auto links = block.links.read<std::uint32_t>(
            std::size_t{block.last_lobe - block.first_lobe} * all_rays_);
        for (auto row = links.begin(); row != links.end(); row += all_rays_)
            all.insert(all.end(), row, row + rows_.rays);
    }
    return all;
}

}  // namespace glowworm
