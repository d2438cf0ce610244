#include "preprocess/read/kept_blocks.h"

#include <algorithm>
#include <utility>

#include "preprocess/read/append_block.h"

namespace glowworm {

bool KeptBlocks::next(PointBlock& block) {
    if (file_.next_block(block)) {
        counts_.invalid += block.invalid;
        counts_.no_colour += block.no_colour;
        counts_.no_intensity += block.no_intensity;
        counts_.not_finite += drop_not_finite(block);
        counts_.too_far += drop_too_far(block);
        if (counts_.no_return == 0) lone_ = first_at_origin(block);
        counts_.no_return += drop_at_origin(block);
        counts_.kept += block.size();
        return true;
    }
    if (counts_.no_return != 1) return false;
    counts_.no_return = 0;
    counts_.kept += 1;
    block = std::exchange(lone_, {});
    return true;
}

}  // namespace glowworm
