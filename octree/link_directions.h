#pragma once

#include <cstdint>
#include <span>

#include "octree/vec3.h"

namespace glowworm {

inline constexpr std::uint32_t kMostLinks = 1024;  ///< rays of a lobe

/// The rays along which light arrives at a lobe: points of the R2 sequence (Roberts 2018), shifted
/// by a hash of the lobe (Cranley-Patterson) and mapped to the cosine round its normal. In fixed
/// point, so that they are the same on every machine. The first n of them are a good set for every
/// n.
class RaysOfLobe {
  public:
    /// `normal` is unit.
    RaysOfLobe(std::uint32_t lobe, const Vec3f& normal);

    /// Unit; of ray number `ray`, below kMostLinks.
    Vec3f direction(std::uint32_t ray) const;

    /// Of the first x.size() rays, how far they go along tangent() and bitangent(), and along the
    /// normal: unit together. All three of one size.
    void components(std::span<float> x, std::span<float> y, std::span<float> z) const;

    const Vec3f& tangent() const { return tangent_; }
    const Vec3f& bitangent() const { return bitangent_; }

  private:
    std::uint32_t seed_;   // of the sines
    float cosine_, sine_;  // of the angle that all rays are turned by
    Vec3f tangent_, bitangent_, normal_;
};

/// RaysOfLobe::direction of a lobe's ray number `ray`.
Vec3f link_direction(std::uint32_t lobe, std::uint32_t ray, const Vec3f& normal);

}  // namespace glowworm
