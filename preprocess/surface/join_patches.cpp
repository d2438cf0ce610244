#include <algorithm>
#include <cmath>
#include <map>
#include <memory_resource>
#include <queue>

#include "preprocess/surface/normal_patches.h"
#include "preprocess/surface/parity_forest.h"

namespace glowworm {
namespace {

struct Candidate {
    float loudness;
    std::uint32_t a, b;
    bool operator<(const Candidate& o) const {
        if (loudness != o.loudness) return loudness < o.loudness;
        return a != o.a ? a > o.a : b > o.b;
    }
};

/// What a root has to say about others, as seen from it.
using Links = std::pmr::map<std::uint32_t, float>;

constexpr std::size_t kLinkBytes = 64;  // at most, of one in its map

/// Links lie in blocks at least this large, bytes, which may lie on disk where memory is short.
constexpr std::size_t kBlock = std::size_t{1} << 22;

}  // namespace

std::vector<std::uint32_t> join_patches(std::size_t count, const std::vector<PatchLink>& links) {
    std::pmr::monotonic_buffer_resource blocks(kBlock);
    std::pmr::unsynchronized_pool_resource pool({0, kLinkBytes}, &blocks);
    std::pmr::vector<Links> links_of(count, &pool);
    for (const PatchLink& link : links) {
        links_of[link.a][link.b] += link.agreement;
        links_of[link.b][link.a] += link.agreement;
    }
    std::priority_queue<Candidate> queue;
    const auto offer = [&](std::uint32_t a, std::uint32_t b, float agreement) {
        if (agreement != 0.0f) queue.push({std::abs(agreement), std::min(a, b), std::max(a, b)});
    };
    for (const PatchLink& link : links)
        offer(link.a, link.b, link.agreement);

    ParityForest forest(count);
    while (!queue.empty()) {
        const Candidate best = queue.top();
        queue.pop();
        const auto found = links_of[best.a].find(best.b);
        if (found == links_of[best.a].end() || std::abs(found->second) != best.loudness) continue;
        const bool opposite = found->second < 0.0f;

        // The one with fewer links leaves them to the other.
        const bool a_stays = links_of[best.a].size() >= links_of[best.b].size();
        const std::uint32_t root = a_stays ? best.a : best.b, gone = a_stays ? best.b : best.a;
        forest.hang(gone, root, opposite);
        links_of[root].erase(gone);
        for (const auto& [other, agreement] : links_of[gone]) {
            if (other == root) continue;
            links_of[other].erase(gone);
            const float sum = links_of[root][other] += opposite ? -agreement : agreement;
            links_of[other][root] = sum;
            offer(root, other, sum);
        }
        Links(&pool).swap(links_of[gone]);
    }
    std::vector<std::uint32_t> components(count);
    for (std::uint32_t patch = 0; patch < count; ++patch) {
        const auto [root, opposite] = forest.find(patch);
        components[patch] = root << 1 | static_cast<std::uint32_t>(opposite);
    }
    return components;
}

}  // namespace glowworm
