// libFuzzer target (preset fuzz): any bytes as an .svo. Seed it with a small file of `glowworm
// build`.

#include <cstddef>
#include <cstdint>

#include "octree_harness.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    glowworm::testing::try_octree_bytes({data, size});
    return 0;
}
