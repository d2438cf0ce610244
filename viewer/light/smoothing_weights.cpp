#include "viewer/light/smoothing_weights.h"

#include <bit>

#include "octree/wide.h"

namespace glowworm {

namespace {

constexpr float kPerWidth = 0.5f;  // smoothing.glsl: 1 / kSmoothing

/// lookup_weight() of light_lookup.glsl, times 6: the cubic B-spline.
inline float spline(float apart) {
    const float d = apart < 0.0f ? -apart : apart;
    const float outer = d < 2.0f ? 2.0f - d : 0.0f;
    const float inner = d < 1.0f ? 1.0f - d : 0.0f;
    return outer * outer * outer - 4.0f * (inner * inner * inner);
}

/// 2^x for -120 <= x <= 0, to 2e-7 of it.
inline float power_of_two(float x) {
    const auto below = static_cast<std::int32_t>(x - 0.5f);  // rounds toward zero: to the nearest
    const float rest = (x - static_cast<float>(below)) * 0.69314718f;
    float sum = rest * (1.0f / 720.0f) + 1.0f / 120.0f;
    sum = sum * rest + 1.0f / 24.0f;
    sum = sum * rest + 1.0f / 6.0f;
    sum = (sum * rest + 0.5f) * rest * rest + rest + 1.0f;
    return sum * std::bit_cast<float>((below + 127) << 23);
}

GLOWWORM_WIDE void weigh(std::size_t count, std::size_t i, const float* __restrict cx,
                         const float* __restrict cy, const float* __restrict cz,
                         const float* __restrict px, const float* __restrict py,
                         const float* __restrict pz, const float* __restrict nx,
                         const float* __restrict ny, const float* __restrict nz,
                         float* __restrict weights) {
    const float x = px[i], y = py[i], z = pz[i];
    const float facing_x = nx[i], facing_y = ny[i], facing_z = nz[i];
    for (std::size_t k = 0; k < count; ++k) {
        const float near = spline(kPerWidth * (cx[k] - x)) * spline(kPerWidth * (cy[k] - y)) *
                           spline(kPerWidth * (cz[k] - z)) * (1.0f / 216.0f);
        const float cosine = facing_x * nx[k] + facing_y * ny[k] + facing_z * nz[k];
        float facing = cosine > 0.0f ? cosine : 0.0f;
        facing *= facing;
        facing *= facing;
        const float height =
            facing_x * (px[k] - x) + facing_y * (py[k] - y) + facing_z * (pz[k] - z);
        const float square = height * height < 16.0f ? height * height : 16.0f;
        weights[k] = near * facing * facing * power_of_two(-4.0f * 1.44269504f * square);
    }
}

}  // namespace

void LobesTogether::clear() {
    lobe.clear();
    for (int a = 0; a < 3; ++a) {
        cell[a].clear();
        position[a].clear();
        normal[a].clear();
    }
}

void LobesTogether::add(std::uint32_t number, const Vec3f& middle, const Vec3f& at,
                        const Vec3f& unit_normal) {
    lobe.push_back(number);
    for (int a = 0; a < 3; ++a) {
        cell[a].push_back(middle[a]);
        position[a].push_back(at[a]);
        normal[a].push_back(unit_normal[a]);
    }
}

void smoothing_weights(const LobesTogether& lobes, std::size_t i, std::vector<float>& weights) {
    weights.resize(lobes.size());
    weigh(lobes.size(), i, lobes.cell[0].data(), lobes.cell[1].data(), lobes.cell[2].data(),
          lobes.position[0].data(), lobes.position[1].data(), lobes.position[2].data(),
          lobes.normal[0].data(), lobes.normal[1].data(), lobes.normal[2].data(), weights.data());
}

}  // namespace glowworm
