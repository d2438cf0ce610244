#pragma once

#include <string>

#include "preprocess/plot/picture.h"

namespace glowworm {

/// The round length (1, 2 or 5 times a power of ten) next below `length` (> 0).
double round_length(double length);

/// A bar of a round length, at most `longest` pixels, from (x, bottom) to the right, its length
/// over it. `scale`: pixels per metre (> 0).
void draw_scale_bar(Picture& picture, int x, int bottom, int longest, double scale, Rgb8 colour);

/// An arrow of `length` pixels up from (x, bottom), the word at its tip.
void draw_arrow(Picture& picture, int x, int bottom, int length, const std::string& word,
                Rgb8 colour);

}  // namespace glowworm
