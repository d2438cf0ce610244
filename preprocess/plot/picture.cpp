#include "preprocess/plot/picture.h"

#include <png.h>

#include <algorithm>

#include "octree/atomic_file.h"
#include "octree/error.h"
#include "preprocess/plot/lettering.h"

namespace glowworm {

static_assert(sizeof(Rgb8) == 3, "libpng reads the pixels as they lie");

Picture::Picture(int columns, int rows, Rgb8 ground)
    : width(columns),
      height(rows),
      pixels(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), ground) {}

void Picture::set(int x, int y, Rgb8 colour) {
    if (holds(x, y)) pixels[place(x, y)] = colour;
}

void Picture::fill(int x, int y, int columns, int rows, Rgb8 colour) {
    for (int v = std::max(y, 0); v < std::min(y + rows, height); ++v) {
        for (int u = std::max(x, 0); u < std::min(x + columns, width); ++u)
            pixels[place(u, v)] = colour;
    }
}

void Picture::write(const std::string& text, int x, int y, Rgb8 colour) {
    draw_text(text, x, y, kLetterScale, [&](int u, int v) { set(u, v, colour); });
}

int written_width(const std::string& text) {
    return text_width(text, kLetterScale);
}

void write_png(const Picture& picture, const std::filesystem::path& path) {
    if (picture.pixels.empty()) {
        throw Error(ExitCode::kDegenerate,
                    "There is nothing to draw into \"" + path.string() + "\"; check the input.");
    }
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(picture.width);
    image.height = static_cast<png_uint_32>(picture.height);
    image.format = PNG_FORMAT_RGB;
    const void* pixels = picture.pixels.data();
    png_alloc_size_t bytes = 0;
    std::vector<std::uint8_t> encoded;
    bool done = png_image_write_to_memory(&image, nullptr, &bytes, 0, pixels, 0, nullptr) != 0;
    if (done) {
        encoded.resize(bytes);
        done =
            png_image_write_to_memory(&image, encoded.data(), &bytes, 0, pixels, 0, nullptr) != 0;
    }
    if (!done) {
        throw Error(ExitCode::kInternal, "The picture \"" + path.string() +
                                             "\" cannot be encoded: " + image.message + ".");
    }
    AtomicFile file(path);
    file.write(encoded.data(), bytes);
    file.commit();
}

}  // namespace glowworm
