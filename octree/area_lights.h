#pragma once

#include <span>

#include "octree/surfel.h"
#include "octree/surfel_stream.h"

namespace glowworm {

/// Puts area lights into a cloud as samples of their rectangles, each light under its own index, so
/// that it can still be found and changed in the octree. Samples that emit already and lie on a
/// rectangle (within 2 cm of its plane and edges, facing its lit side) are taken for the light's
/// own: they get its index and radiance, and where they cover at least half of it none are added.
/// Added samples have albedo 0 and the cloud's median spacing, at least 4 and at most 1000 to an
/// edge. Throws Error (kUnreadable) for a rectangle without area, with a sentence that names it.
void add_area_lights(SurfelCloud& cloud, std::span<const AreaLight> lights);

/// The same for a stream, which is passed over once now; the added samples come last.
SurfelStream with_area_lights(SurfelStream stream, std::span<const AreaLight> lights);

}  // namespace glowworm
