#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "preprocess/read/preflight.h"

namespace glowworm {

struct PhaseTime {
    std::string name;
    double seconds = 0.0;
};

/// A table whose first row is its head.
using Rows = std::vector<std::vector<std::string>>;

/// What the page of a run shows; pictures that are empty are left out, with `no_frame` in place of
/// the first one.
struct RunPage {
    std::string title;               ///< the octree's name
    std::string made;                ///< by which program, when, of how many files
    std::string doubt;               ///< why the poses are not to be trusted; empty: they are
    Rows facts;                      ///< two columns, no head
    std::vector<Warning> warnings;   ///< in full
    std::string trust;               ///< the trust table as text
    Rows levels;                     ///< statistics per level; empty: there is no octree
    std::vector<PhaseTime> timings;  ///< of this run
    std::string plan_png;            ///< content of a PNG, the scans from above
    std::string frame_png;           ///< content of a PNG, the first frame
    std::string no_frame;            ///< why there is none; without levels, why no octree
};

/// One HTML page without anything outside itself: no script, pictures as data.
std::string format_page(const RunPage& page);

/// RFC 4648, padded.
std::string base64(std::span<const std::byte> bytes);

}  // namespace glowworm
