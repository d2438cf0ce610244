#include <tsl/robin_map.h>

#include <algorithm>
#include <cmath>
#include <queue>
#include <utility>

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

using Pair = std::pair<std::uint32_t, std::uint32_t>;  // a < b

Pair pair_of(std::uint32_t a, std::uint32_t b) {
    return std::minmax(a, b);
}

struct PairHash {
    std::size_t operator()(const Pair& pair) const {
        std::uint64_t h = (std::uint64_t{pair.first} << 32 | pair.second) * 0x9e3779b97f4a7c15u;
        return h ^ h >> 32;
    }
};

/// What roots say about each other, in few bytes and without pointers: where memory is short it
/// lies on disk. A root has a list of whom it has links with; an entry may be out of date, and
/// then says the same as another one or nothing.
class RootLinks {
  public:
    RootLinks(std::size_t count, const std::vector<PatchLink>& links)
        : first_(count, kNone), last_(count, kNone), degrees_(count) {
        sums_.max_load_factor(0.8f);
        sums_.reserve(links.size());
        entries_.reserve(2 * links.size());
        for (const PatchLink& link : links) {
            const auto [sum, is_new] = sums_.try_emplace(pair_of(link.a, link.b), 0.0f);
            sum.value() += link.agreement;
            if (!is_new) continue;
            for (const auto& [from, to] : {Pair{link.a, link.b}, Pair{link.b, link.a}}) {
                ++degrees_[from];
                entries_.push_back({to, kNone});
                append(from, static_cast<std::uint32_t>(entries_.size() - 1));
            }
        }
    }

    /// With how many others it has links.
    std::uint32_t degree(std::uint32_t root) const { return degrees_[root]; }

    /// The agreement of two roots that have a link, else 0.
    float agreement(std::uint32_t a, std::uint32_t b) const {
        const auto found = sums_.find(pair_of(a, b));
        return found == sums_.end() ? 0.0f : found->second;
    }

    /// `gone`, which hangs under `root` in the forest by now, leaves its links to it. Calls
    /// offer(root, other, agreement) for each link of `root` that changes.
    template <typename Offer>
    void hand_over(std::uint32_t gone, std::uint32_t root, bool opposite, ParityForest& forest,
                   const Offer& offer) {
        if (sums_.erase(pair_of(gone, root)) > 0) --degrees_[root];
        std::uint32_t next = kNone;
        for (std::uint32_t i = first_[gone]; i != kNone; i = next) {
            next = entries_[i].next;
            const std::uint32_t other = forest.find(entries_[i].to).first;
            const auto found = sums_.find(pair_of(gone, other));
            if (found == sums_.end()) continue;
            const float agreement = opposite ? -found->second : found->second;
            sums_.erase(found);
            const auto [sum, is_new] = sums_.try_emplace(pair_of(root, other), 0.0f);
            sum.value() += agreement;
            if (is_new) {
                ++degrees_[root];
                append(root, i);
            } else {
                --degrees_[other];
            }
            offer(root, other, sum->second);
        }
        first_[gone] = last_[gone] = kNone;
        degrees_[gone] = 0;
    }

  private:
    static constexpr std::uint32_t kNone = 0xffffffffu;

    struct Entry {
        std::uint32_t to;    ///< a patch of the other root's
        std::uint32_t next;  ///< entry of the same list
    };

    void append(std::uint32_t root, std::uint32_t entry) {
        entries_[entry].next = kNone;
        (last_[root] == kNone ? first_[root] : entries_[last_[root]].next) = entry;
        last_[root] = entry;
    }

    tsl::robin_map<Pair, float, PairHash> sums_;
    std::vector<Entry> entries_;
    std::vector<std::uint32_t> first_, last_, degrees_;  ///< [patches]
};

}  // namespace

std::vector<std::uint32_t> join_patches(std::size_t count, const std::vector<PatchLink>& links) {
    RootLinks links_of(count, links);
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
        const float agreement = links_of.agreement(best.a, best.b);
        if (std::abs(agreement) != best.loudness) continue;
        const bool opposite = agreement < 0.0f;

        // The one with fewer links leaves them to the other.
        const bool a_stays = links_of.degree(best.a) >= links_of.degree(best.b);
        const std::uint32_t root = a_stays ? best.a : best.b, gone = a_stays ? best.b : best.a;
        forest.hang(gone, root, opposite);
        links_of.hand_over(gone, root, opposite, forest, offer);
    }
    std::vector<std::uint32_t> components(count);
    for (std::uint32_t patch = 0; patch < count; ++patch) {
        const auto [root, opposite] = forest.find(patch);
        components[patch] = root << 1 | static_cast<std::uint32_t>(opposite);
    }
    return components;
}

}  // namespace glowworm
