#pragma once

#include <cstddef>
#include <vector>

#include "octree/vec3.h"

namespace glowworm {

/// A picture's layers before exposure, linear Rec.709, row 0 at the top: [height * width] each.
struct FrameLayers {
    int width = 0, height = 0;
    std::vector<Vec3f> direct;      ///< reflected radiance that came straight from a light
    std::vector<Vec3f> indirect;    ///< reflected radiance that was reflected before
    std::vector<Vec3f> specular;    ///< mirrored radiance of wet walls
    std::vector<Vec3f> emission;    ///< radiance of visible area lights
    std::vector<Vec3f> albedo;      ///< linear, 0..1
    std::vector<Vec3f> normal;      ///< world, unit or zero where nothing was hit
    std::vector<float> depth;       ///< m along the view axis; 0 where nothing was hit
    std::vector<float> ndf_length;  ///< Toksvig length, 0..1

    FrameLayers() = default;
    FrameLayers(int w, int h) : width(w), height(h) {
        const std::size_t pixels = static_cast<std::size_t>(w) * static_cast<std::size_t>(h);
        for (auto* layer : {&direct, &indirect, &specular, &emission, &albedo, &normal}) {
            layer->resize(pixels);
        }
        depth.resize(pixels);
        ndf_length.resize(pixels);
    }

    /// What the eye sees: direct + indirect + specular + emission.
    Vec3f beauty(std::size_t pixel) const {
        return direct[pixel] + indirect[pixel] + specular[pixel] + emission[pixel];
    }
};

/// A picture to look at: sRGB-encoded, row 0 at the top.
struct Picture {
    int width = 0, height = 0;
    std::vector<unsigned char> rgb;  ///< [height * width * 3]
};

}  // namespace glowworm
