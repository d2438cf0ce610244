#include "preprocess/surface/neighbours.h"

#include <algorithm>
#include <numeric>

#include "preprocess/surface/distances.h"

namespace glowworm {
namespace {

float gap2(float low_a, float high_a, float low_b, float high_b) {
    const float gap = std::max(std::max(low_a - high_b, low_b - high_a), 0.0f);
    return gap * gap;
}

/// Squared distance between two boxes. Rounding is monotonic, so it never exceeds the distance
/// computed between points of theirs.
float box_distance2(const Vec3f& low_a, const Vec3f& high_a, const Vec3f& low_b,
                    const Vec3f& high_b) {
    return gap2(low_a.x, high_a.x, low_b.x, high_b.x) + gap2(low_a.y, high_a.y, low_b.y, high_b.y) +
           gap2(low_a.z, high_a.z, low_b.z, high_b.z);
}

}  // namespace

/// The leaves within `reach2` of a box, those that follow each other joined.
void NearestSearch::collect_ranges(const Vec3f& low, const Vec3f& high, float reach2) {
    ranges_.clear();
    stack_.assign(1, 0);
    while (!stack_.empty()) {
        const PointTree::Node& node = tree_->nodes[stack_.back()];
        stack_.pop_back();
        if (node.children == 0) {
            if (!ranges_.empty() && ranges_.back().end == node.first) {
                ranges_.back().end = node.first + node.count;
            } else {
                ranges_.push_back({node.first, node.first + node.count});
            }
            continue;
        }
        for (std::uint32_t c = node.first_child + node.children; c-- > node.first_child;) {
            const PointTree::Node& child = tree_->nodes[c];
            if (box_distance2(low, high, child.low, child.high) <= reach2) stack_.push_back(c);
        }
    }
}

void NearestSearch::gather(std::span<const std::uint32_t> queries, int count, float radius) {
    radius2_ = radius * radius;

    // The points around the queries in Morton order bound how far their neighbours can be.
    const auto [first, last] = std::minmax_element(queries.begin(), queries.end());
    const auto reach = static_cast<std::uint32_t>(count);
    const auto total = static_cast<std::uint32_t>(tree_->size());
    const std::uint32_t begin = *first - std::min(*first, reach);
    const std::uint32_t end = total - *last > reach ? *last + 1 + reach : total;
    const std::size_t window = end - begin;
    const auto wanted = static_cast<std::size_t>(count) + 1;  // the point itself is among them
    distance2_.resize(std::max(distance2_.size(), window));
    Vec3f low = tree_->position(queries[0]), high = low;
    float reach2 = 0.0f;
    for (const std::uint32_t query : queries) {
        const Vec3f position = tree_->position(query);
        low = component_min(low, position);
        high = component_max(high, position);
        measure_distances(tree_->x.data() + begin, tree_->y.data() + begin, tree_->z.data() + begin,
                          window, position, distance2_.data());
        const float bound = bound_of(distance2_.data(), window, wanted, radius2_, reach2);
        reach2 = std::max(reach2, bound);
    }

    collect_ranges(low, high, reach2);
    gathered_ = 0;
    for (const Range& range : ranges_)
        gathered_ += range.end - range.begin;
    padded_ = pad(gathered_);
    if (index_.size() < padded_) {
        x_.resize(padded_);
        y_.resize(padded_);
        z_.resize(padded_);
        index_.resize(padded_);
        chosen_.resize(padded_);
        result_.resize(padded_);
    }
    distance2_.resize(std::max(distance2_.size(), padded_));
    std::size_t place = 0;
    for (const Range& range : ranges_) {
        const std::size_t size = range.end - range.begin;
        std::copy_n(tree_->x.data() + range.begin, size, x_.data() + place);
        std::copy_n(tree_->y.data() + range.begin, size, y_.data() + place);
        std::copy_n(tree_->z.data() + range.begin, size, z_.data() + place);
        std::iota(index_.data() + place, index_.data() + place + size, range.begin);
        place += size;
    }
    std::fill(x_.data() + gathered_, x_.data() + padded_, std::numeric_limits<float>::infinity());
    std::fill(y_.data() + gathered_, y_.data() + padded_, 0.0f);
    std::fill(z_.data() + gathered_, z_.data() + padded_, 0.0f);
}

void NearestSearch::measure(std::uint32_t query) {
    query_ = query;
    measure_distances(x_.data(), y_.data(), z_.data(), padded_, tree_->position(query),
                      distance2_.data());
}

/// Puts the places (in the gathered arrays) of the `count` nearest, ascending, into chosen_.
void NearestSearch::select(int count) {
    const auto keep = static_cast<std::size_t>(count);
    const auto wanted = static_cast<float>(keep + 1);
    const float bound =
        bound_of(distance2_.data(), padded_, keep + 1, radius2_, area_per_point_ * wanted);
    area_per_point_ = bound / wanted;
    std::size_t found = places_within(distance2_.data(), padded_, bound, chosen_.data());
    const auto self = std::find_if(chosen_.data(), chosen_.data() + found,
                                   [&](std::uint32_t place) { return index_[place] == query_; });
    if (self != chosen_.data() + found) {
        std::copy(self + 1, chosen_.data() + found, self);
        --found;
    }
    chosen_count_ = found;
    drop_surplus(keep);
}

/// Leaves the `count` nearest of the chosen where equal distances let more in. The smaller index,
/// which is the smaller place, goes first.
void NearestSearch::drop_surplus(std::size_t count) {
    if (chosen_count_ <= count) return;
    const auto middle = chosen_.begin() + static_cast<std::ptrdiff_t>(count);
    std::nth_element(chosen_.begin(), middle,
                     chosen_.begin() + static_cast<std::ptrdiff_t>(chosen_count_),
                     [&](std::uint32_t a, std::uint32_t b) { return is_nearer(a, b); });
    std::sort(chosen_.begin(), middle);
    chosen_count_ = count;
}

bool NearestSearch::is_nearer(std::uint32_t a, std::uint32_t b) const {
    return distance2_[a] < distance2_[b] || (distance2_[a] == distance2_[b] && a < b);
}

std::span<const std::uint32_t> NearestSearch::listed() {
    for (std::size_t i = 0; i < chosen_count_; ++i)
        result_[i] = index_[chosen_[i]];
    return {result_.data(), chosen_count_};
}

std::span<const std::uint32_t> NearestSearch::nearest(int count) {
    select(count);
    return listed();
}

std::span<const std::uint32_t> NearestSearch::nearest_of_those(int count) {
    const auto keep = static_cast<std::size_t>(count);
    if (chosen_count_ <= keep) return listed();
    const std::size_t padded = pad(chosen_count_);
    near_.assign(padded, std::numeric_limits<float>::infinity());
    float largest = 0.0f;
    for (std::size_t i = 0; i < chosen_count_; ++i) {
        near_[i] = distance2_[chosen_[i]];
        largest = std::max(largest, near_[i]);
    }
    const float guess = largest * static_cast<float>(count) / static_cast<float>(chosen_count_);
    const float bound = bound_of(near_.data(), padded, keep, largest, guess);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < chosen_count_; ++i) {
        chosen_[kept] = chosen_[i];
        kept += near_[i] <= bound;
    }
    chosen_count_ = kept;
    drop_surplus(keep);
    return listed();
}

std::span<const std::uint32_t> NearestSearch::nearest_in_order(int count) {
    select(count);
    std::sort(chosen_.begin(), chosen_.begin() + static_cast<std::ptrdiff_t>(chosen_count_),
              [&](std::uint32_t a, std::uint32_t b) { return is_nearer(a, b); });
    return listed();
}

std::vector<std::uint32_t> nearest_neighbours(const PointTree& tree, int count, float radius) {
    const auto stride = static_cast<std::size_t>(count);
    std::vector<std::uint32_t> rows(tree.size() * stride, kNoNeighbour);
    for_each_neighbourhood(tree, count, radius, [&](std::uint32_t i, NearestSearch& search) {
        std::ranges::copy(search.nearest_in_order(count),
                          rows.begin() + static_cast<std::ptrdiff_t>(i * stride));
    });
    return rows;
}

}  // namespace glowworm
