#include "viewer/frame/frame.h"

#include <algorithm>

namespace glowworm {
namespace {

constexpr int kTileEdge = 1024;  // sub-pixels: what the buffers of a tile are sized for

/// A pixel's sums over its sub-pixels.
struct PixelSums {
    Vec3f direct, indirect, specular, emission, albedo, normal;
    float depth = 0.0f, ndf_length = 0.0f, hits = 0.0f;
};

Vec3f rgb(const gpu::vec4& v) {
    return {v.x, v.y, v.z};
}

/// A drawn tile as the GPU left it, read back once.
struct Tile {
    int width;  ///< sub-pixels
    std::vector<gpu::vec4> surfaces, albedos, direct, indirect, specular, emission;

    void add(std::size_t sub_pixel, PixelSums& sums) const {
        sums.direct += rgb(direct[sub_pixel]);
        sums.indirect += rgb(indirect[sub_pixel]);
        sums.specular += rgb(specular[sub_pixel]);
        sums.emission += rgb(emission[sub_pixel]);
        if (surfaces[sub_pixel].w <= 0.0f) return;
        sums.normal += rgb(surfaces[sub_pixel]);
        sums.depth += surfaces[sub_pixel].w;
        sums.albedo += rgb(albedos[sub_pixel]);
        sums.ndf_length += albedos[sub_pixel].w;
        sums.hits += 1.0f;
    }
};

/// Radiance averages over all of a pixel, what describes the surface over the part that is one.
void store(const PixelSums& sums, int samples, FrameLayers& layers, std::size_t pixel) {
    const float share = 1.0f / static_cast<float>(samples * samples);
    layers.direct[pixel] = sums.direct * share;
    layers.indirect[pixel] = sums.indirect * share;
    layers.specular[pixel] = sums.specular * share;
    layers.emission[pixel] = sums.emission * share;
    if (sums.hits == 0.0f) return;
    layers.normal[pixel] = normalized(sums.normal);
    layers.depth[pixel] = sums.depth / sums.hits;
    layers.albedo[pixel] = sums.albedo / sums.hits;
    layers.ndf_length[pixel] = sums.ndf_length / sums.hits;
}

}  // namespace

Frame::Frame(const Context& context, const OctreeView& octree, const FrameSettings& settings)
    : octree_(octree),
      settings_(settings),
      cloud_(octree, static_cast<std::size_t>(context.device().max_storage_bytes),
             settings.point_memory) {
    settings_.selection.resident = cloud_.resident();
}

void Frame::set_panels(std::span<const AreaLight> panels) {
    shading_.set_panels(panels, octree_.grid.origin);
}

void Frame::draw(const View& view, const LightField& light, int sub_pixels, PassTimer* timer) {
    std::vector<ChunkSelection> selection;
    timed(timer, "select", [&] {
        selection = select_chunks(octree_.chunks, octree_.grid.origin, view, settings_.selection);
    });
    surfels_drawn_ = 0;
    for (const ChunkSelection& chunk : selection)
        surfels_drawn_ += chunk.count;
    gbuffer_.draw(octree_, cloud_, selection, view, timer);
    timed(timer, "shade",
          [&] { shading_.draw(gbuffer_, light, view, sub_pixels, settings_.wetness); });
}

FrameLayers Frame::render(const View& view, const LightField& light, const Progress& progress) {
    const int samples = settings_.samples, edge = kTileEdge / samples;
    FrameLayers layers(view.width, view.height);
    std::uint64_t done = 0;
    for (int top = 0; top < view.height; top += edge) {
        for (int left = 0; left < view.width; left += edge) {
            const int width = std::min(edge, view.width - left);
            const int height = std::min(edge, view.height - top);
            draw(supersampled(tile_of(view, left, top, width, height), samples), light, samples);

            const std::size_t count = static_cast<std::size_t>(width * height * samples * samples);
            const auto read = [&](const Buffer& buffer) { return buffer.read<gpu::vec4>(count); };
            const Tile tile{width * samples,           read(gbuffer_.surfaces()),
                            read(gbuffer_.albedos()),  read(shading_.direct()),
                            read(shading_.indirect()), read(shading_.specular()),
                            read(shading_.emission())};
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    PixelSums sums;
                    for (int s = 0; s < samples * samples; ++s) {
                        const int row = y * samples + s / samples,
                                  column = x * samples + s % samples;
                        tile.add(static_cast<std::size_t>(row * tile.width + column), sums);
                    }
                    store(sums, samples, layers,
                          static_cast<std::size_t>((top + y) * view.width + left + x));
                }
            }
            done += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
            if (progress) progress(done, layers.depth.size());
        }
    }
    return layers;
}

}  // namespace glowworm
