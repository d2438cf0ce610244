#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "preprocess/points.h"

namespace glowworm {

/// Pixels per dot of the letters in pictures, and between two lines of them.
inline constexpr int kLetterScale = 2;
inline constexpr int kLineHeight = 24;

/// An 8-bit sRGB picture, row 0 at the top. What is drawn beyond its edges is left out.
struct Picture {
    int width = 0, height = 0;
    std::vector<Rgb8> pixels;  ///< [height x width]

    Picture() = default;
    Picture(int columns, int rows, Rgb8 ground);

    void set(int x, int y, Rgb8 colour);
    void fill(int x, int y, int columns, int rows, Rgb8 colour);

    /// One line of ASCII with its upper left corner at (x, y).
    void write(const std::string& text, int x, int y, Rgb8 colour);

    Rgb8 at(int x, int y) const { return pixels[place(x, y)]; }
    bool holds(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }

  private:
    std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
               static_cast<std::size_t>(x);
    }
};

/// Width in pixels of a line that Picture::write draws.
int written_width(const std::string& text);

/// Writes a PNG, whole or not at all. Throws Error as AtomicFile does, kDegenerate for an empty
/// picture.
void write_png(const Picture& picture, const std::filesystem::path& path);

}  // namespace glowworm
