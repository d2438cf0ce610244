#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

// A file may say that some of its points have no colour or no intensity: the camera did not look
// there. What it stores for them, mostly zero, would become black rock.

/// Gives the points whose flag in `missing`, one per colour, is not 0 the mean of the others, or
/// the grey of half the light (sRGB 188) where there are no others. Returns how many.
std::uint64_t fill_missing(std::span<const std::uint8_t> missing, std::vector<Rgb8>& colours);

/// The same for intensities; 0.5 where there are no others.
std::uint64_t fill_missing(std::span<const std::uint8_t> missing, std::vector<float>& intensities);

}  // namespace glowworm
