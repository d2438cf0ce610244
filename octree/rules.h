#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace glowworm {

/// What is wrong with a file, one full sentence each.
using Sentences = std::vector<std::string>;

/// How often a rule is broken and where first.
struct Broken {
    std::size_t count = 0;
    std::size_t first = std::numeric_limits<std::size_t>::max();
};

/// Counts, in parallel, the indices in [0, count) for which `broken` holds.
template <typename Rule>
Broken find_broken(std::size_t count, const Rule& broken) {
    constexpr std::size_t kGrain = 8192;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, count, kGrain), Broken{},
        [&](const auto& range, Broken sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                if (!broken(i)) continue;
                ++sum.count;
                sum.first = std::min(sum.first, i);
            }
            return sum;
        },
        [](const Broken& a, const Broken& b) {
            return Broken{a.count + b.count, std::min(a.first, b.first)};
        });
}

/// Adds a sentence such as "17 of 400 lobes have no area, first at lobe 3".
template <typename Rule>
void expect_all(Sentences& sentences, std::size_t count, const char* noun, const char* failure,
                const Rule& broken) {
    const Broken found = find_broken(count, broken);
    if (found.count == 0) return;
    sentences.push_back(std::to_string(found.count) + " of " + std::to_string(count) + " " + noun +
                        "s " + failure + ", first at " + noun + " " + std::to_string(found.first));
}

}  // namespace glowworm
