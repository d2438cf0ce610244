#pragma once

#include <cstdint>

#include "octree/links.h"
#include "octree/trace.h"

namespace glowworm {

/// How reflected light reaches a lobe.
enum class Gather {
    kLinks,  ///< along rays traced once and kept
    kCones,  ///< by cones through the filtered octree
};

/// Where gather rays are traced and light goes along them.
enum class RunOn {
    kFaster,  ///< the CPU where OpenGL runs on it too, else the GPU
    kCpu,
    kGpu,
};

struct LightSettings {
    Gather gather = Gather::kLinks;
    std::uint32_t links =
        LinkSettings{}.rays;  ///< rays per lobe, 1..1024; baked ones are used when as many
    int cones = 6;            ///< 4, 5, 6, 9, 10 or 16
    bool faithful = false;    ///< cones exactly as the 2016 paper's configuration
    bool tricubic = true;     ///< lookup between lobes; false: trilinear
    TraceSettings trace = {};
    RunOn run_on = RunOn::kFaster;
    std::uint64_t memory = 0;  ///< bytes that light may take on the GPU; 0: any
};

}  // namespace glowworm
