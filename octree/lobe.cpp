#include "octree/lobe.h"

#include <bit>

#include "octree/pack.h"

namespace glowworm {
namespace {

constexpr std::size_t kEmitters = 6;
constexpr double kSameSide = 0.5;  ///< cosine of 60°: nearer normals belong to one lobe

/// 0..5: -x, +x, -y, +y, -z, +z, whichever lies nearest to `normal`.
std::size_t nearest_axis(const Vec3d& normal) {
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    if (x >= y && x >= z) return normal.x > 0.0 ? 1 : 0;
    if (y >= z) return normal.y > 0.0 ? 3 : 2;
    return normal.z > 0.0 ? 5 : 4;
}

double cosine_between(const LobeSums& a, const LobeSums& b) {
    return dot(normalized(a.ndf), normalized(b.ndf));
}

/// In 1/255 of the leaf's edge from its lower corner.
double steps_of(double v) {
    return std::clamp((v + 0.5) * 255.0, 0.0, 255.0);
}

std::uint32_t pack_rounded_down(const Vec3d& corner) {
    const auto axis = [](double v) { return static_cast<std::uint32_t>(steps_of(v)); };
    return axis(corner.x) | axis(corner.y) << 8 | axis(corner.z) << 16;
}

std::uint32_t pack_rounded_up(const Vec3d& corner) {
    const auto axis = [](double v) {
        const auto down = static_cast<std::uint32_t>(steps_of(v));
        return down + (steps_of(v) > down ? 1u : 0u);
    };
    return axis(corner.x) | axis(corner.y) << 8 | axis(corner.z) << 16;
}

/// rms distance from the plane through the mean with the mean normal, in leaf edges: the samples'
/// covariance along that normal.
double plane_spread(const LobeSums& sums) {
    const Vec3d mean = sums.position / sums.area;
    const Vec3d n = normalized(sums.ndf);
    const double* m = sums.moments;
    const double second = n.x * n.x * m[0] + n.y * n.y * m[1] + n.z * n.z * m[2] +
                          2.0 * (n.x * n.y * m[3] + n.x * n.z * m[4] + n.y * n.z * m[5]);
    const double offset = dot(n, mean);
    return std::sqrt(std::max(0.0, second / sums.area - offset * offset));
}

void store(Vec3d v, float (&out)[3]) {
    out[0] = static_cast<float>(v.x);
    out[1] = static_cast<float>(v.y);
    out[2] = static_cast<float>(v.z);
}

Lobe lobe_of(const LobeSums& sums, const LeafSums& leaf) {
    Lobe lobe{};
    store(leaf.centre + sums.position * (leaf.edge / sums.area), lobe.position);
    lobe.area = static_cast<float>(sums.area);
    store(sums.ndf / sums.area, lobe.ndf);
    lobe.plane_sigma = static_cast<float>(plane_spread(sums) * leaf.edge);
    store(sums.albedo / sums.area, lobe.albedo);
    lobe.light = sums.light;
    lobe.patch_min = pack_rounded_down(sums.lower);
    lobe.patch_max = pack_rounded_up(sums.upper);
    lobe.emission = pack_rgb9e5(vec3_cast<float>(sums.emission / sums.area));
    lobe.spacing = static_cast<float>(std::sqrt(sums.area / sums.surfels));
    return lobe;
}

/// The second moments of samples that scatter by `sigma` along `n`.
void add_spread(const Vec3d& n, double sigma, LobeSums& sums) {
    const double a = sums.area * sigma * sigma;
    const double products[6] = {n.x * n.x, n.y * n.y, n.z * n.z, n.x * n.y, n.x * n.z, n.y * n.z};
    for (int i = 0; i < 6; ++i)
        sums.moments[i] += a * products[i];
}

}  // namespace

void LobeSums::operator+=(const LobeSums& other) {
    lower = component_min(lower, other.lower);
    upper = component_max(upper, other.upper);
    area += other.area;
    surfels += other.surfels;
    position += other.position;
    ndf += other.ndf;
    albedo += other.albedo;
    emission += other.emission;
    for (int i = 0; i < 6; ++i)
        moments[i] += other.moments[i];
    if (light == 0 || (other.light != 0 && other.light < light)) light = other.light;
}

void LeafSums::begin(const Vec3d& cell_min, double cell_edge) {
    edge = cell_edge;
    centre = cell_min + Vec3d{0.5, 0.5, 0.5} * cell_edge;
    used = 0;
}

void LeafSums::add(const LobeSample& sample) {
    add_box(sample, sample.position, sample.position);
}

void LeafSums::add_box(const LobeSample& sample, const Vec3d& lower, const Vec3d& upper) {
    const Vec3d p = (sample.position - centre) / edge;
    const double a = sample.area;
    LobeSums piece{
        a,
        sample.surfels,
        p * a,
        sample.ndf * a,
        sample.albedo * a,
        sample.emission * a,
        {a * p.x * p.x, a * p.y * p.y, a * p.z * p.z, a * p.x * p.y, a * p.x * p.z, a * p.y * p.z},
        (lower - centre) / edge,
        (upper - centre) / edge,
        sample.light};
    if (sample.plane_sigma > 0.0)
        add_spread(normalized(sample.ndf), sample.plane_sigma / edge, piece);
    add_sums(sample, piece);
}

void LeafSums::add_pieces(const LobeSample& sample, const PieceMoments& pieces) {
    const double a = sample.area;
    const double(&m)[6] = pieces.products;
    add_sums(sample, {a,
                      sample.surfels,
                      pieces.mean * a,
                      sample.ndf * a,
                      sample.albedo * a,
                      sample.emission * a,
                      {m[0] * a, m[1] * a, m[2] * a, m[3] * a, m[4] * a, m[5] * a},
                      pieces.lower,
                      pieces.upper,
                      sample.light});
}

void LeafSums::add_sums(const LobeSample& sample, const LobeSums& sums) {
    const std::size_t index = sample.emits() ? kEmitters : nearest_axis(sample.ndf);
    if (used >> index & 1u) {
        classes[index] += sums;
    } else {
        classes[index] = sums;
        used |= 1u << index;
    }
}

std::size_t LeafSums::finish(std::array<Lobe, kMaxLobes>& lobes) const {
    std::size_t count = 0;

    const std::uint32_t surface = used & 0x3fu;
    if (surface != 0) {
        std::size_t largest = static_cast<std::size_t>(std::countr_zero(surface));
        if (std::has_single_bit(used)) {
            lobes[0] = lobe_of(classes[largest], *this);
            return 1;
        }
        for (std::size_t i = largest + 1; i < kEmitters; ++i) {
            if ((surface >> i & 1u) && classes[i].area > classes[largest].area) largest = i;
        }
        LobeSums front = classes[largest];
        LobeSums back;
        bool has_back = false;
        for (std::size_t i = 0; i < kEmitters; ++i) {
            if (i == largest || !(surface >> i & 1u)) continue;
            if (cosine_between(classes[i], classes[largest]) > kSameSide) {
                front += classes[i];
            } else if (has_back) {
                back += classes[i];
            } else {
                back = classes[i];
                has_back = true;
            }
        }
        if (has_back && cosine_between(front, back) > kSameSide) {
            front += back;
            has_back = false;
        }
        if (has_back && back.area > front.area) std::swap(front, back);
        lobes[count++] = lobe_of(front, *this);
        if (has_back) lobes[count++] = lobe_of(back, *this);
    }

    if (used >> kEmitters & 1u) lobes[count++] = lobe_of(classes[kEmitters], *this);
    return count;
}

}  // namespace glowworm
