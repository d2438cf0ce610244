#include "octree/links.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include "octree/close_patches.h"
#include "octree/link_directions.h"

namespace glowworm {

namespace {

constexpr std::size_t kRowsAtOnce = 1 << 12;  // between two calls of progress
constexpr std::size_t kRowsInBatch = 16;
constexpr std::size_t kRaysInBatch = 1 << 11;  // are sorted: they and more fit a cache
constexpr std::uint32_t kDirections = 4;       // cells of directions along each axis

/// Which of kDirections³ cells of directions one lies in.
std::uint32_t cell_of_directions(const Vec3f& direction) {
    const auto along = [](float d) {
        return static_cast<std::uint32_t>((std::clamp(d, -0.99f, 0.99f) + 1.0f) *
                                          (0.5f * kDirections));
    };
    return (along(direction.z) * kDirections + along(direction.y)) * kDirections +
           along(direction.x);
}

/// Rays of some rows that lie side by side. Those that go similar ways follow one another, so that
/// what they read is in caches.
class Batch {
  public:
    void add(const OctreeView& octree, std::uint32_t lobe, std::uint32_t ray, std::size_t place) {
        if (rays_.empty() || lobe != lobe_) {
            lobe_ = lobe;
            const Lobe from = is_finite(octree.lobes[lobe]) ? octree.lobes[lobe] : Lobe{};
            of_lobe_ = RaysOfLobe(lobe, normalized(to_vec3(from.ndf)));
            from_ = ray_from_lobe(octree, from, {});
        }
        from_.direction = of_lobe_.direction(ray);
        rays_.push_back(from_);
        places_.push_back(place);
    }

    /// Writes what each meets to its place, and is empty again.
    void trace(const RayTracer& tracer, std::span<std::uint32_t> links) {
        cells_.resize(rays_.size());
        std::array<std::uint32_t, kDirections * kDirections * kDirections + 1> starts{};
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            cells_[i] = cell_of_directions(rays_[i].direction);
            ++starts[cells_[i] + 1];
        }
        std::partial_sum(starts.begin(), starts.end(), starts.begin());
        sorted_.resize(rays_.size());
        place_of_.resize(rays_.size());
        for (std::size_t i = 0; i < rays_.size(); ++i) {
            const std::uint32_t at = starts[cells_[i]]++;
            sorted_[at] = rays_[i];
            place_of_[at] = places_[i];
        }
        hits_.resize(rays_.size());
        tracer.trace(sorted_, hits_);
        for (std::size_t i = 0; i < hits_.size(); ++i)
            links[place_of_[i]] = hits_[i];
        rays_.clear();
        places_.clear();
    }

    std::size_t size() const { return rays_.size(); }

  private:
    std::uint32_t lobe_ = 0;
    RaysOfLobe of_lobe_{0, {0.0f, 0.0f, 1.0f}};
    Ray from_;
    std::vector<Ray> rays_, sorted_;
    std::vector<std::size_t> places_, place_of_;
    std::vector<std::uint32_t> cells_, hits_;
};

}  // namespace

LinkTracer::LinkTracer(const OctreeView& octree, const TraceSettings& settings)
    : LinkTracer(octree, make_ray_tracer(octree, settings)) {}

LinkTracer::LinkTracer(const OctreeView& octree, std::shared_ptr<const RayTracer> tracer)
    : octree_(octree), tracer_(std::move(tracer)) {}

void LinkTracer::trace(const LinkRays& wanted, std::span<std::uint32_t> links,
                       const Progress& progress) const {
    const std::size_t count = wanted.rows.size();
    for (std::size_t begin = 0; begin < count; begin += kRowsAtOnce) {
        if (progress) progress(begin, count);
        const std::size_t end = std::min(count, begin + kRowsAtOnce);
        tbb::parallel_for(tbb::blocked_range(begin, end, kRowsInBatch), [&](const auto& range) {
            Batch batch;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const std::uint32_t row = wanted.rows[i];
                for (std::uint32_t ray = wanted.first; ray < wanted.last; ++ray) {
                    const std::uint32_t lobe = wanted.lobe_of ? wanted.lobe_of(row, ray) : row;
                    batch.add(octree_, lobe, ray, std::size_t{row} * wanted.stride + ray);
                }
                if (batch.size() >= kRaysInBatch) batch.trace(*tracer_, links);
            }
            batch.trace(*tracer_, links);
        });
    }
    if (progress) progress(count, count);
}

std::vector<std::uint32_t> trace_links(const OctreeView& octree, const LinkSettings& settings,
                                       const Progress& progress,
                                       std::shared_ptr<const RayTracer> tracer) {
    std::vector<std::uint32_t> rows(octree.lobes.size());
    std::iota(rows.begin(), rows.end(), 0u);
    std::vector<std::uint32_t> links(octree.lobes.size() * settings.rays);
    if (!tracer) tracer = make_ray_tracer(octree, settings.trace);
    LinkTracer(octree, std::move(tracer))
        .trace({rows, 0, settings.rays, settings.rays, {}}, links, progress);
    return links;
}

}  // namespace glowworm
