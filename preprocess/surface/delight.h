#pragma once

#include <cstddef>
#include <string>

#include "octree/surfel.h"

namespace glowworm {

/// How a scanner's flash or laser made its colours brighter near by and face on, and what was done
/// about it.
struct DelightReport {
    bool applied = false;
    double distance_exponent = 0.0;   ///< colour ~ distance^-p; 2 for a bare flash
    double incidence_exponent = 0.0;  ///< colour ~ cosine^q; 1 for a bare flash
    std::size_t pairs = 0;            ///< places that two stations saw
    double rms_before = 0.0;          ///< of the two stations' colours, natural logarithm
    double rms_after = 0.0;
    std::string reason;  ///< a sentence: why nothing was done; empty where applied
};

/// Takes the falloff of the stations' own light out of the albedo:
///
///     colour = albedo · gain(station) · distance^-p · cosine^q
///
/// p and q are the same for all stations, the gains (exposures) one for each. They are fitted to
/// places that two stations saw from different distances and angles: there the albedo is the same
/// and drops out of the logarithms' difference (robust linear least squares). The median albedo
/// stays. Surfels of stations without a viewpoint stay as they are. Where stations overlap too
/// little, or saw what they share from alike, nothing changes and the report says so. The same
/// result on any number of threads.
DelightReport delight(SurfelCloud& cloud);

}  // namespace glowworm
