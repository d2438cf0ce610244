#pragma once

#include <string>

#include "viewer/frame/layers.h"

namespace glowworm {

/// A PNG file's bytes: 8-bit RGB marked as sRGB. The same picture gives the same bytes.
std::string encode_png(const Picture& picture);

}  // namespace glowworm
