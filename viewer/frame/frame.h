#pragma once

#include <span>

#include "octree/octree_file.h"
#include "octree/progress.h"
#include "viewer/frame/gbuffer.h"
#include "viewer/frame/layers.h"
#include "viewer/frame/shading.h"

namespace glowworm {

struct FrameSettings {
    SelectionSettings selection;
    /// Bytes on the GPU that points may take; 0: no limit. A larger cloud is drawn coarser.
    std::uint64_t point_memory = 0;
    float wetness = 0.0f;  ///< 0..1: how much of the walls a film of water covers
    int samples = 2;       ///< 1..8: a headless frame's pixels are means of this many squared
};

/// One cloud, drawn frame after frame. The octree must outlive it.
class Frame {
  public:
    Frame(const Context& context, const OctreeView& octree, const FrameSettings& settings = {});

    void set_panels(std::span<const AreaLight> panels);

    /// What to do about surfels that are not on the GPU yet.
    enum class Missing {
        kAskFor,   ///< draw what is there, coarser; a later frame has more
        kWaitFor,  ///< bring them first
    };

    /// Select, splat, shade: `view`'s pixels lie in beauty() afterwards. `timer`, where given,
    /// takes each pass's time.
    void draw(const View& view, const LightField& light, Missing missing = Missing::kAskFor,
              PassTimer* timer = nullptr);
    /// Whether the last draw had all the surfels it wanted.
    bool is_complete() const { return complete_; }

    /// A frame of any size with all its layers and surfels, tile by tile; `progress` counts pixels.
    FrameLayers render(const View& view, const LightField& light, const Progress& progress = {});

    const Buffer& beauty() const { return shading_.beauty(); }
    const GBuffer& gbuffer() const { return gbuffer_; }
    const Shading& shading() const { return shading_; }
    /// Draws by shaders where compiled code would be faster: to compare the two.
    void force_shaders(bool force) {
        gbuffer_.force_shaders(force);
        shading_.force_shaders(force);
    }
    void set_wetness(float wetness) { settings_.wetness = wetness; }
    void set_selection(const SelectionSettings& selection) { settings_.selection = selection; }
    /// By the last draw; of these what lies deep is thinned further (ChunkSelection::full_depth).
    std::uint64_t surfels_drawn() const { return surfels_drawn_; }
    /// By the last draw left out, behind others.
    std::uint64_t surfels_hidden() const { return surfels_hidden_; }
    /// That the last draw or render wanted of one view and point_memory has no room for.
    std::uint64_t surfels_without_room() const { return surfels_without_room_; }

    /// What draw() does before it shades: `view`'s surfaces lie in gbuffer() afterwards.
    void draw_surfaces(const View& view, Missing missing, PassTimer* timer = nullptr);

  private:
    OctreeView octree_;
    FrameSettings settings_;
    std::vector<ChunkBox> boxes_;  ///< [chunks]
    SurfelCache cloud_;
    GBuffer gbuffer_;
    Shading shading_;
    std::vector<bool> seen_;  ///< [chunks] in the last frame; empty before the first
    bool complete_ = true;
    std::uint64_t surfels_drawn_ = 0, surfels_hidden_ = 0, surfels_without_room_ = 0;
};

}  // namespace glowworm
