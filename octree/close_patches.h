#pragma once

#include <vector>

#include "octree/octree_file.h"

namespace glowworm {

/// [lobes] the octree's lobes, each patch widened to its leaf's face or edge wherever the surface
/// goes on in the leaf beyond, so that neighbouring pieces of plane meet: samples end short of the
/// faces by chance, and light would leak between. Where the surface ends, a patch keeps to its
/// samples and silhouettes stay sharp. A lobe with a number that is not finite becomes all zero: no
/// ray meets it and it is black. What traces rays (trace.h) works on these.
std::vector<Lobe> close_patches(const OctreeView& octree);

/// Whether all of its numbers are finite.
bool is_finite(const Lobe& lobe);

}  // namespace glowworm
