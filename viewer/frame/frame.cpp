#include "viewer/frame/frame.h"
#include "viewer/gpu/vec4.h"

#include <algorithm>

namespace glowworm {
namespace {

constexpr int kTileEdge = 1024;  // sub-pixels: what the buffers of a tile are sized for

/// A pixel's sums over its sub-pixels.
struct PixelSums {
    Vec3f direct, indirect, specular, emission, albedo, normal;
    float depth = 0.0f, ndf_length = 0.0f, hits = 0.0f;
};

std::uint64_t surfels_in(std::span<const ChunkSelection> selection) {
    std::uint64_t all = 0;
    for (const ChunkSelection& selected : selection)
        all += selected.count;
    return all;
}

/// How many chunks, the nearest, hold a quarter of what is selected.
std::size_t nearest_part(std::span<const ChunkSelection> selection) {
    const std::uint64_t all = surfels_in(selection);
    std::uint64_t before = 0;
    std::size_t part = 0;
    while (part < selection.size() && 4 * before < all)
        before += selection[part++].count;
    return part;
}

/// How many chunks were seen; they come first now, else the order stays.
std::size_t put_seen_first(std::vector<ChunkSelection>& selection, const std::vector<bool>& seen) {
    const auto rest = std::stable_partition(selection.begin(), selection.end(),
                                            [&](const auto& s) { return seen[s.chunk]; });
    return static_cast<std::size_t>(rest - selection.begin());
}

/// The pixels of a tile as the GPU left it, read back once.
struct Pixels {
    int width;  ///< sub-pixels
    std::vector<gpu::vec4> surfaces, albedos, direct, indirect, specular, emission;

    void add(std::size_t sub_pixel, PixelSums& sums) const {
        sums.direct += to_vec3(direct[sub_pixel]);
        sums.indirect += to_vec3(indirect[sub_pixel]);
        sums.specular += to_vec3(specular[sub_pixel]);
        sums.emission += to_vec3(emission[sub_pixel]);
        if (surfaces[sub_pixel].w <= 0.0f) return;
        sums.normal += to_vec3(surfaces[sub_pixel]);
        sums.depth += surfaces[sub_pixel].w;
        sums.albedo += to_vec3(albedos[sub_pixel]);
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
      boxes_(chunk_boxes(octree)),
      cloud_(octree, static_cast<std::size_t>(context.device().max_storage_bytes),
             settings.point_memory) {}

void Frame::set_panels(std::span<const AreaLight> panels) {
    shading_.set_panels(panels, octree_.grid.origin);
}

void Frame::draw(const View& view, const LightField& light, Missing missing, PassTimer* timer) {
    draw_surfaces(view, missing, timer);
    timed(timer, "shade", [&] { shading_.draw(gbuffer_, light, view, 1, settings_.wetness); });
}

/// The chunks that the last frame saw first; then those of the others that their surfaces do not
/// hide: what is hidden would change no pixel, but where a rim opens farther than a tile of the
/// pyramid.
void Frame::draw_surfaces(const View& view, Missing missing, PassTimer* timer) {
    const bool wait = missing == Missing::kWaitFor;
    std::vector<ChunkSelection> wanted;
    std::size_t first = 0;
    timed(timer, "select", [&] {
        wanted =
            select_chunks(octree_.chunks, boxes_, octree_.grid.origin, view, settings_.selection);
        const std::uint64_t all = surfels_in(wanted);
        fit_into(wanted, cloud_.blocks_for(wanted.size()), SurfelCache::kBlock);
        surfels_without_room_ = all - surfels_in(wanted);
        first = seen_.empty() ? nearest_part(wanted) : put_seen_first(wanted, seen_);
    });
    const auto as_drawn = [&](const ChunkSelection& selected) {
        return wait ? selected : thinned(selected, cloud_.resident(selected.chunk));
    };
    const auto add = [&](std::span<const ChunkSelection> part) {
        if (wait) cloud_.load(part);
        std::vector<ChunkSelection> drawn(part.size());
        std::ranges::transform(part, drawn.begin(), as_drawn);
        surfels_drawn_ += surfels_in(drawn);
        gbuffer_.add(octree_, cloud_, drawn, timer);
    };
    const auto hidden = [&](const DepthPyramid& pyramid, const ChunkSelection& selected) {
        const ChunkSelection drawn = as_drawn(selected);
        const ChunkBox& box = boxes_[selected.chunk];
        const double depth =
            dot(octree_.grid.origin + box.centre - view.position, view.forward) + length(box.half);
        const double radius = drawn.scale * std::max(depth / drawn.full_depth, 1.0) *
                              octree_.chunks[selected.chunk].max_radius;
        return is_hidden(pyramid, view, octree_.grid.origin, box, radius);
    };

    surfels_drawn_ = 0;
    cloud_.begin_frame();
    gbuffer_.begin(octree_, view);
    add(std::span(wanted).first(first));
    DepthPyramid pyramid = gbuffer_.pyramid(timer);
    const auto rest = wanted.begin() + static_cast<std::ptrdiff_t>(first);
    const auto visible_end = std::stable_partition(
        rest, wanted.end(), [&](const ChunkSelection& s) { return !hidden(pyramid, s); });
    if (visible_end != rest) {
        add(std::span(rest, visible_end));
        pyramid = gbuffer_.pyramid(timer);
    }
    surfels_hidden_ = surfels_in(std::span(visible_end, wanted.end()));
    wanted.erase(visible_end, wanted.end());
    gbuffer_.finish(cloud_, timer);

    seen_.assign(octree_.chunks.size(), false);
    for (const ChunkSelection& selected : wanted)
        seen_[selected.chunk] = !hidden(pyramid, selected);
    complete_ = wait || cloud_.request(wanted);
}

FrameLayers Frame::render(const View& view, const LightField& light, const Progress& progress) {
    const int samples = settings_.samples, edge = kTileEdge / samples;
    FrameLayers layers(view.width, view.height);
    std::uint64_t done = 0, without_room = 0;
    for (int top = 0; top < view.height; top += edge) {
        for (int left = 0; left < view.width; left += edge) {
            const int width = std::min(edge, view.width - left);
            const int height = std::min(edge, view.height - top);
            seen_.clear();  // a frame does not depend on those before it
            const View tile = supersampled(tile_of(view, left, top, width, height), samples);
            draw_surfaces(tile, Missing::kWaitFor, nullptr);
            without_room = std::max(without_room, surfels_without_room_);
            shading_.draw(gbuffer_, light, tile, samples, settings_.wetness);

            const std::size_t count = static_cast<std::size_t>(width * height * samples * samples);
            const auto read = [&](const Buffer& buffer) { return buffer.read<gpu::vec4>(count); };
            const Pixels pixels{width * samples,           read(gbuffer_.surfaces()),
                                read(gbuffer_.albedos()),  read(shading_.direct()),
                                read(shading_.indirect()), read(shading_.specular()),
                                read(shading_.emission())};
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    PixelSums sums;
                    for (int s = 0; s < samples * samples; ++s) {
                        const int row = y * samples + s / samples,
                                  column = x * samples + s % samples;
                        pixels.add(static_cast<std::size_t>(row * pixels.width + column), sums);
                    }
                    store(sums, samples, layers,
                          static_cast<std::size_t>((top + y) * view.width + left + x));
                }
            }
            done += static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
            if (progress) progress(done, layers.depth.size());
        }
    }
    surfels_without_room_ = without_room;
    return layers;
}

}  // namespace glowworm
