#pragma once

#include <vector>

#include "viewer/frame/layers.h"

namespace glowworm {

/// Stops that bring the middle of `luminances` to middle grey (0.18): the mean of the logarithms
/// between the 20th and the 95th percentile, so that neither unlit corners nor lamps decide it.
/// Luminances that are not positive are passed over; without any, 0.
double measured_exposure(std::vector<float> luminances);

/// The same for a finished frame.
double measured_exposure(const FrameLayers& layers);

}  // namespace glowworm
