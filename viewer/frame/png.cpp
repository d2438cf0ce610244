#include "viewer/frame/png.h"

#include <png.h>

#include "octree/error.h"

namespace glowworm {
namespace {

[[noreturn]] void fail(png_structp, png_const_charp message) {
    throw Error(ExitCode::kInternal, std::string("libpng: ") + message);
}

void append(png_structp png, png_bytep data, png_size_t bytes) {
    static_cast<std::string*>(png_get_io_ptr(png))->append(reinterpret_cast<char*>(data), bytes);
}

/// libpng's two handles, freed together whatever happens.
struct Writer {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, nullptr);
    png_infop info = png_create_info_struct(png);
    Writer() = default;
    Writer(const Writer&) = delete;
    Writer& operator=(const Writer&) = delete;
    ~Writer() { png_destroy_write_struct(&png, &info); }
};

}  // namespace

std::string encode_png(const Picture& picture) {
    std::string bytes;
    Writer writer;
    png_set_write_fn(writer.png, &bytes, append, nullptr);
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(picture.width),
                 static_cast<png_uint_32>(picture.height), 8, PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB_gAMA_and_cHRM(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(writer.png, writer.info);
    const std::size_t row_bytes = static_cast<std::size_t>(picture.width) * 3;
    for (int row = 0; row < picture.height; ++row) {
        png_write_row(writer.png, picture.rgb.data() + static_cast<std::size_t>(row) * row_bytes);
    }
    png_write_end(writer.png, writer.info);
    return bytes;
}

}  // namespace glowworm
