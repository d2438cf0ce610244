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
constexpr std::size_t kSums = 4;

using Channels [[gnu::vector_size(16), gnu::aligned(4), gnu::may_alias]] = float;

/// What a link brings; nothing where it meets nothing, without a branch.
inline const Channels* source(std::span<const gpu::vec4> radiance, std::uint32_t link) {
    static constexpr gpu::vec4 kBlack(0.0f);
    const gpu::vec4* from = link < radiance.size() ? &radiance[link] : &kBlack;
    return reinterpret_cast<const Channels*>(from);
}

template <typename Visit>
void for_each_lobe(std::size_t lobes, const Visit& visit) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lobes, kLobesPerTask),
                      [&](const auto& range) {
                          for (std::size_t lobe = range.begin(); lobe != range.end(); ++lobe)
                              visit(lobe);
                      });
}

/// How far along its tangent and bitangent the irradiance of a lobe turns by each of its rays.
class TurnsOfRays {
  public:
    explicit TurnsOfRays(std::size_t rays) : x_(rays), y_(rays), z_(rays) {}

    struct Along {
        std::span<const float> x, y;
    };
    Along of(const RaysOfLobe& rays) {
        rays.components(x_, y_, z_);
        for (std::size_t ray = 0; ray < z_.size(); ++ray) {
            const float per_cosine = 1.0f / std::max(z_[ray], IrradianceTurn::kLeastCosine);
            x_[ray] *= per_cosine;
            y_[ray] *= per_cosine;
        }
        return {x_, y_};
    }

  private:
    std::vector<float> x_, y_, z_;
};

}  // namespace

float open_rays(std::span<const std::uint32_t> row) {
    const auto buried = std::ranges::count(row, kBuried);
    return static_cast<float>(std::max<std::ptrdiff_t>(std::ssize(row) - buried, 1));
}

void bounce_along(const LinkRows& rows, std::span<const gpu::vec4> radiance,
                  std::span<gpu::vec4> gathered) {
    for_each_lobe(gathered.size(), [&](std::size_t lobe) {
        const auto row = rows.of(lobe);
        // Several sums at a time: one alone waits for each of its additions.
        Channels sums[kSums] = {};
        std::size_t ray = 0;
        for (; ray + kSums <= row.size(); ray += kSums) {
            for (std::size_t k = 0; k < kSums; ++k)
                sums[k] += *source(radiance, row[ray + k]);
        }
        for (; ray < row.size(); ++ray)
            sums[0] += *source(radiance, row[ray]);
        const Channels sum = ((sums[0] + sums[1]) + (sums[2] + sums[3])) * (kPi / open_rays(row));
        gathered[lobe] = {sum[0], sum[1], sum[2], 0.0f};
    });
}

std::vector<gpu::LobeLight> light_gradients(const LinkRows& rows, std::span<const Lobe> lobes,
                                            std::span<const gpu::vec4> radiance,
                                            std::span<const gpu::vec4> irradiance,
                                            std::span<const std::uint32_t> walls) {
    std::vector<gpu::LobeLight> lights(lobes.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, lobes.size(), kLobesPerTask),
                      [&](const auto& range) {
                          TurnsOfRays turns(rows.rays);
                          for (std::size_t lobe = range.begin(); lobe != range.end(); ++lobe) {
                              const auto row = rows.of(lobe);
                              const RaysOfLobe rays(static_cast<std::uint32_t>(lobe),
                                                    normalized(to_vec3(lobes[lobe].ndf)));
                              const auto [along_x, along_y] = turns.of(rays);
                              Channels x[2] = {}, y[2] = {};
                              for (std::size_t ray = 0; ray < row.size(); ++ray) {
                                  const Channels from = *source(radiance, row[ray]);
                                  x[ray & 1] += from * along_x[ray];
                                  y[ray & 1] += from * along_y[ray];
                              }
                              const Channels x_all = x[0] + x[1], y_all = y[0] + y[1];
                              IrradianceTurn turn;
                              turn.add(rays.tangent(), {x_all[0], x_all[1], x_all[2]});
                              turn.add(rays.bitangent(), {y_all[0], y_all[1], y_all[2]});
                              lights[lobe] = turn.light(irradiance[lobe], walls[lobe],
                                                        open_rays(row), to_vec3(radiance[lobe]));
                          }
                      });
    return lights;
}

}  // namespace glowworm
