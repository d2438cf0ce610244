#pragma once

#include <vector>

#include "viewer/light/lookup.h"

namespace glowworm {

/// [lobes] with the noise of each lobe's rays spread over the surface within two leaves: the twin
/// of smooth_light.comp, for where OpenGL runs on the CPU and for groups of lobes. On all cores,
/// the same on any number of them.
std::vector<gpu::LobeLight> smoothed(const LookupInput& input);

}  // namespace glowworm
