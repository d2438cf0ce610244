#pragma once

#include <functional>
#include <string>

namespace glowworm {

/// Size of text drawn with draw_text at `scale` pixels per dot.
int text_width(const std::string& text, int scale);
int text_height(int scale);

/// Calls `dot(x, y)` for every pixel of `text` with its upper left corner at (x, y); characters
/// outside ASCII appear as "?".
void draw_text(const std::string& text, int x, int y, int scale,
               const std::function<void(int, int)>& dot);

}  // namespace glowworm
