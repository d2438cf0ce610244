#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "viewer/frame/splat_input.h"
#include "viewer/gpu/program.h"

namespace glowworm {

/// Discs rasterised by compute: 32-bit atomics find the nearest at each pixel, then all within a
/// radius of it are summed. Sums are integers, so the order of discs does not matter. Every pass
/// expects the view and the pixels' surfaces to be bound.
class SplatShaders {
  public:
    /// Begins a frame of that many pixels.
    void begin(std::size_t pixels);
    /// Adds the draws from `first_draw` on, as far as depth goes.
    void add(const SplatInput& input, std::size_t first_draw);
    /// [depth_tiles] the farthest depth in each square of DEPTH_TILE pixels, m; then [width_tiles]
    /// pixels that the widest disc spans which touches each square of WIDTH_TILE.
    std::pair<std::vector<float>, std::vector<std::uint32_t>> tiles(std::size_t depth_tiles,
                                                                    std::size_t width_tiles);
    /// Averages what lies within a radius behind the nearest disc.
    void blend(const SplatInput& input);
    /// Lets through what lies behind rims, and closes gaps.
    void open_rims(const SplatInput& input);
    /// Makes surfaces of the sums, and leaves all clean for the next frame.
    void resolve();

  private:
    void bind() const;
    void splat(const Program& pass, const SplatInput& input, std::size_t first_draw) const;

    Program depth_{{"splat_depth.comp"}}, blend_{{"splat_blend.comp"}};
    Program depth_behind_{{"splat_depth.comp"}, {"BEHIND_RIMS"}};
    Program blend_behind_{{"splat_blend.comp"}, {"BEHIND_RIMS"}};
    Program depth_tiles_{{"depth_tiles.comp"}};
    Program find_rims_{{"rim_find.comp"}}, open_rims_{{"rim_open.comp"}};
    Program resolve_{{"surface_resolve.comp"}};
    Buffer chunks_, batches_, tiles_;
    Buffer depths_, rims_, rim_tiles_, normal_sums_, albedo_sums_, behind_sums_;
    std::size_t pixels_ = 0;
};

}  // namespace glowworm
