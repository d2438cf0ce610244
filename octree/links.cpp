#include "octree/links.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "octree/close_patches.h"
#include "octree/ray_tracer.h"

namespace glowworm {

namespace {

constexpr std::uint32_t kLobesAtOnce = 1 << 12;  // between two calls of progress
constexpr std::uint32_t kLobesInBatch = 16;      // whose rays are sorted: they and more fit a cache
constexpr std::uint32_t kDirections = 4;         // cells of directions along each axis

// Fractions of the plastic number's powers in 1/2^32: R2's steps.
constexpr std::uint32_t kStepU = 3242174889u;
constexpr std::uint32_t kStepV = 2447445414u;

/// Bijective scramble of 32 bits (PCG's output function, Jarzynski and Olano 2020).
std::uint32_t scramble(std::uint32_t value) {
    const std::uint32_t state = value * 747796405u + 2891336453u;
    const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

/// The 24 high bits as a number in [0, 1): exact in float.
float unit_fraction(std::uint32_t fixed) {
    return static_cast<float>(fixed >> 8u) * (1.0f / 16777216.0f);
}

Vec3f normal_of(const Lobe& lobe) {
    return normalized(Vec3f{lobe.ndf[0], lobe.ndf[1], lobe.ndf[2]});
}

/// What the directions of a lobe's rays have in common.
struct RaysOfLobe {
    std::uint32_t seed, other_seed;
    Vec3f tangent, bitangent, normal;

    RaysOfLobe(std::uint32_t lobe, const Vec3f& unit_normal)
        : seed(scramble(lobe)), other_seed(scramble(seed)), normal(unit_normal) {
        // An orthonormal frame without branches at the poles (Duff et al. 2017).
        const float sign = std::copysign(1.0f, normal.z);
        const float a = -1.0f / (sign + normal.z);
        const float b = normal.x * normal.y * a;
        tangent = {1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x};
        bitangent = {b, sign + normal.y * normal.y * a, -normal.y};
    }

    Vec3f direction(std::uint32_t ray) const {
        const float u = unit_fraction(seed + (ray + 1u) * kStepU);
        const float v = unit_fraction(other_seed + (ray + 1u) * kStepV);
        const float sine = std::sqrt(u);
        const float angle = 2.0f * std::numbers::pi_v<float> * v;
        return tangent * (sine * std::cos(angle)) + bitangent * (sine * std::sin(angle)) +
               normal * std::sqrt(1.0f - u);
    }
};

/// Which of kDirections³ cells of directions one lies in.
std::uint32_t cell_of_directions(const Vec3f& direction) {
    const auto along = [](float d) {
        return static_cast<std::uint32_t>((std::clamp(d, -0.99f, 0.99f) + 1.0f) *
                                          (0.5f * kDirections));
    };
    return (along(direction.z) * kDirections + along(direction.y)) * kDirections +
           along(direction.x);
}

/// Traces the links of some lobes that lie side by side. Rays that go similar ways follow one
/// another, so that what they read is in caches.
class Batch {
  public:
    Batch(const OctreeView& octree, std::uint32_t rays) : octree_(octree), rays_(rays) {}

    /// Writes the links of the lobes from `first` to before `last`, row after row.
    void trace(const RayTracer& tracer, std::uint32_t first, std::uint32_t last,
               std::span<std::uint32_t> links) {
        const std::size_t count = std::size_t{last - first} * rays_;
        directions_.resize(count);
        cell_.resize(count);
        std::array<std::uint32_t, kDirections * kDirections * kDirections + 1> starts{};
        for (std::uint32_t lobe = first, i = 0; lobe < last; ++lobe) {
            const RaysOfLobe of(lobe, normal_of(octree_.lobes[lobe]));
            for (std::uint32_t ray = 0; ray < rays_; ++ray, ++i) {
                directions_[i] = of.direction(ray);
                cell_[i] = cell_of_directions(directions_[i]);
                ++starts[cell_[i] + 1];
            }
        }
        std::partial_sum(starts.begin(), starts.end(), starts.begin());
        sorted_.resize(count);
        link_of_.resize(count);
        for (std::uint32_t lobe = first, i = 0; lobe < last; ++lobe) {
            Ray ray = ray_from_lobe(octree_, octree_.lobes[lobe], {});
            for (std::uint32_t k = 0; k < rays_; ++k, ++i) {
                ray.direction = directions_[i];
                const std::uint32_t place = starts[cell_[i]]++;
                sorted_[place] = ray;
                link_of_[place] = i;
            }
        }
        hits_.resize(count);
        tracer.trace(sorted_, hits_);
        for (std::size_t i = 0; i < count; ++i)
            links[link_of_[i]] = hits_[i];
    }

  private:
    const OctreeView& octree_;
    std::uint32_t rays_;
    std::vector<Vec3f> directions_;
    std::vector<std::uint32_t> cell_, link_of_, hits_;
    std::vector<Ray> sorted_;
};

}  // namespace

Vec3f link_direction(std::uint32_t lobe, std::uint32_t ray, const Vec3f& normal) {
    return RaysOfLobe(lobe, normal).direction(ray);
}

std::vector<std::uint32_t> trace_links(const OctreeView& octree, const LinkSettings& settings,
                                       const Progress& progress) {
    const std::vector<Lobe> closed = close_patches(octree);
    OctreeView traced = octree;
    traced.lobes = closed;
    const RayTracer tracer(traced, settings.trace);
    const auto lobes = static_cast<std::uint32_t>(closed.size());
    const std::size_t rays = settings.rays;
    std::vector<std::uint32_t> links(lobes * rays);
    for (std::uint32_t begin = 0; begin < lobes; begin += kLobesAtOnce) {
        if (progress) progress(begin, lobes);
        const std::uint32_t end = std::min(lobes, begin + kLobesAtOnce);
        tbb::parallel_for(tbb::blocked_range(begin, end, kLobesInBatch), [&](const auto& range) {
            Batch batch(traced, settings.rays);
            for (std::uint32_t first = range.begin(); first < range.end();) {
                const std::uint32_t last = std::min(range.end(), first + kLobesInBatch);
                batch.trace(tracer, first, last,
                            std::span(links).subspan(first * rays, (last - first) * rays));
                first = last;
            }
        });
    }
    if (progress) progress(lobes, lobes);
    return links;
}

}  // namespace glowworm
