#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "octree/link_directions.h"
#include "octree/octree_file.h"
#include "octree/progress.h"
#include "octree/ray_tracer.h"
#include "octree/trace.h"

namespace glowworm {

/// Light arrives at a lobe along a fixed set of cosine-distributed rays. A ray's link is the lobe
/// that it meets; as long as nothing moves, a bounce of light is a product over the links.
struct LinkSettings {
    std::uint32_t rays = 128;  ///< per lobe, 1..kMostLinks
    TraceSettings trace = {};
};

/// Rays of a lobe that are traced before the others where light is shown meanwhile: a gather by so
/// many takes less time than one by six cones, and comes nearer.
inline constexpr std::uint32_t kPreviewRays = 16;

/// [lobes x settings.rays] hit lobes, kNoHit or kBuried, on all cores; the same on any number of
/// them. Rays of a lobe are consecutive and the first n of them are a good set for every n.
/// `progress` counts lobes and may throw to cancel. `tracer` is the octree's, where there is one
/// already.
std::vector<std::uint32_t> trace_links(const OctreeView& octree, const LinkSettings& settings,
                                       const Progress& progress = {},
                                       std::shared_ptr<const RayTracer> tracer = nullptr);

/// Rays of rows of links, `stride` apart: of each of `rows` the rays from `first` to before `last`.
struct LinkRays {
    std::span<const std::uint32_t> rows;
    std::uint32_t first = 0, last = 0;
    std::uint32_t stride = 0;
    /// The lobe that a row's ray leaves; where it is empty, that of the row's number.
    std::function<std::uint32_t(std::uint32_t row, std::uint32_t ray)> lobe_of;
};

/// Traces links a part at a time: some rows, or the first rays of each before the others.
class LinkTracer {
  public:
    /// The octree must outlive it.
    LinkTracer(const OctreeView& octree, const TraceSettings& settings);
    /// With a tracer of this octree that is there already.
    LinkTracer(const OctreeView& octree, std::shared_ptr<const RayTracer> tracer);
    LinkTracer(const LinkTracer&) = delete;
    LinkTracer& operator=(const LinkTracer&) = delete;

    /// Writes the lobes that are met to their places among `links`, on all cores; what lies
    /// elsewhere among them is not touched, and may be read meanwhile. `progress` counts rows.
    void trace(const LinkRays& wanted, std::span<std::uint32_t> links,
               const Progress& progress = {}) const;

  private:
    OctreeView octree_;
    std::shared_ptr<const RayTracer> tracer_;
};

}  // namespace glowworm
