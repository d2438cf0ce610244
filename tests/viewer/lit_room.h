#pragma once

#include "analytic_cave.h"
#include "octree/build.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm::testing {

inline constexpr Vec3f kRoomLow{-2.0f, -1.5f, 0.0f}, kRoomHigh{2.0f, 1.5f, 2.4f};

/// A closed room of points on a jittered grid of 4 cm, with one lamp, and what draws it.
struct LitRoom {
    Context context = Context::headless();
    Octree octree = build_octree(closed_room(kRoomLow, kRoomHigh, 0.04f), {.depth = 5});
    Scene scene{{{"lamp", {0.5, 0.3, 1.4}, {3, 3, 3}}}, {}, {}, {}};
    LightField light{context, octree.view(), scene};
    Frame frame{context, octree.view(), {.selection = {}, .samples = 1}};
};

}  // namespace glowworm::testing
