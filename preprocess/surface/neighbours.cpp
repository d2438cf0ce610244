#include "preprocess/surface/neighbours.h"

#include <algorithm>
#include <numbers>
#include <numeric>

#include "preprocess/surface/distances.h"

namespace glowworm {
namespace {

/// How much farther than expected (squared) a leaf's neighbours are looked for, and how many more
/// than wanted a query picks to choose from: few miss, and little is measured in vain.
constexpr float kBoxMargin = 2.5f;
constexpr float kLastMargin = 1.4f;
constexpr float kPickMargin = 1.3f;
constexpr float kPickMore = 1.5f;

/// Points that tell how dense they are.
constexpr std::uint32_t kDensityPoints = 12;

/// A strip of points is taken to be at least this wide, of its length.
constexpr float kNarrowest = 0.125f;

/// More than this many times the wanted are thinned before they are put in order.
constexpr std::size_t kTooMany = 4;

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

void NearestSearch::begin(int count, float radius) {
    count_ = static_cast<std::size_t>(count);
    radius2_ = radius * radius;
}

/// The stretch of the Morton order that holds the queries and points enough to tell the density.
NearestSearch::Window NearestSearch::window_of(std::span<const std::uint32_t> queries) const {
    const auto [first, last] = std::minmax_element(queries.begin(), queries.end());
    const std::uint32_t size = *last + 1 - *first;
    const std::uint32_t more = size < kDensityPoints ? (kDensityPoints - size + 1) / 2 : 0;
    const auto total = static_cast<std::uint32_t>(tree_->size());
    return {*first - std::min(*first, more), *last + 1 + std::min(total - *last - 1, more)};
}

/// How far the neighbours will be where the points lie as densely on a surface as those of `run`.
float NearestSearch::expected_reach2(Window run) {
    Vec3f low = tree_->position(run.begin), high = low;
    for (std::uint32_t i = run.begin + 1; i < run.end; ++i) {
        low = component_min(low, tree_->position(i));
        high = component_max(high, tree_->position(i));
    }
    const Vec3f size = high - low;
    const float longest = std::max({size.x, size.y, size.z});
    const float shortest = std::min({size.x, size.y, size.z});
    const float middle =
        std::max(size.x + size.y + size.z - longest - shortest, kNarrowest * longest);
    const float points_per_area = static_cast<float>(run.end - run.begin) / (longest * middle);
    const float by_box = kBoxMargin / (points_per_area * std::numbers::pi_v<float>);
    const float by_last = kLastMargin * largest_area_;
    const float area = by_last > 0.0f ? std::min(by_box, by_last) : by_box;
    const float reach2 = area * static_cast<float>(count_ + 1);
    largest_area_ = 0.0f;
    return reach2 < radius2_ ? reach2 : radius2_;
}

/// The points around the queries in Morton order bound how far their neighbours can be.
float NearestSearch::sure_reach2(std::span<const std::uint32_t> queries, Window run) {
    const auto reach = static_cast<std::uint32_t>(count_);
    const auto total = static_cast<std::uint32_t>(tree_->size());
    run.begin -= std::min(run.begin, reach);
    run.end += std::min(total - run.end, reach);
    if (run.end - run.begin <= count_) return radius2_;
    float reach2 = 0.0f;
    for (const std::uint32_t query : queries) {
        const Vec3f from = tree_->position(query);
        distance2_.clear();
        for (std::uint32_t i = run.begin; i < run.end; ++i) {
            const Vec3f offset = tree_->position(i) - from;
            distance2_.push_back(dot(offset, offset));
        }
        const auto last = distance2_.begin() + static_cast<std::ptrdiff_t>(count_);
        std::nth_element(distance2_.begin(), last, distance2_.end());
        reach2 = std::max(reach2, *last);
    }
    return std::min(reach2, radius2_);
}

/// The leaves within `reach2` of a box, those that follow each other joined.
void NearestSearch::collect_windows(const Vec3f& low, const Vec3f& high, float reach2) {
    windows_.clear();
    stack_.assign(1, 0);
    while (!stack_.empty()) {
        const PointTree::Node& node = tree_->nodes[stack_.back()];
        stack_.pop_back();
        if (node.children == 0) {
            if (!windows_.empty() && windows_.back().end == node.first) {
                windows_.back().end = node.first + node.count;
            } else {
                windows_.push_back({node.first, node.first + node.count});
            }
            continue;
        }
        for (std::uint32_t c = node.first_child + node.children; c-- > node.first_child;) {
            const PointTree::Node& child = tree_->nodes[c];
            if (box_distance2(low, high, child.low, child.high) <= reach2) stack_.push_back(c);
        }
    }
}

void NearestSearch::gather(std::span<const std::uint32_t> queries, float reach2) {
    reach2_ = reach2;
    Vec3f low = tree_->position(queries[0]), high = low;
    for (const std::uint32_t query : queries) {
        low = component_min(low, tree_->position(query));
        high = component_max(high, tree_->position(query));
    }
    collect_windows(low, high, reach2);
    std::size_t points = 0;
    for (const Window& window : windows_)
        points += window.end - window.begin;
    size_ = pad(points);
    if (gathered_.size() < size_) {
        for (std::vector<float>* column : {&x_, &y_, &z_})
            column->resize(size_);
        gathered_.resize(size_);
        places_.resize(size_ + kLanes);
    }
    distance2_.resize(std::max(distance2_.size(), size_ + kLanes));
    std::size_t place = 0;
    for (const Window& window : windows_) {
        const std::size_t size = window.end - window.begin;
        std::copy_n(tree_->x.data() + window.begin, size, x_.data() + place);
        std::copy_n(tree_->y.data() + window.begin, size, y_.data() + place);
        std::copy_n(tree_->z.data() + window.begin, size, z_.data() + place);
        std::iota(gathered_.data() + place, gathered_.data() + place + size, window.begin);
        place += size;
    }
    for (std::vector<float>* column : {&x_, &y_, &z_})
        std::fill(column->data() + points, column->data() + size_,
                  std::numeric_limits<float>::infinity());
}

/// Finds the neighbours of a query among the gathered; false where they may be farther away.
bool NearestSearch::find(std::uint32_t query) {
    const Vec3f from = tree_->position(query);
    const std::size_t wanted = count_ + 1;  // the point itself is among them
    const auto pick = [&](float bound2) {
        return find_within(x_.data(), y_.data(), z_.data(), size_, from, bound2, places_.data(),
                           distance2_.data());
    };
    float bound2 = kPickMargin * area_per_point_ * static_cast<float>(wanted);
    if (!(bound2 > 0.0f)) bound2 = reach2_;
    std::size_t near = pick(std::min(bound2, reach2_));
    while (near < wanted && bound2 < reach2_) {
        bound2 *= kPickMore;
        near = pick(std::min(bound2, reach2_));
    }
    const bool is_sure = near >= wanted || reach2_ >= radius2_;
    if (!is_sure) return false;

    if (near > kTooMany * wanted) near = thin(near, wanted);
    const std::size_t room = pad(near);
    if (ranks_.size() < room) {
        ranks_.resize(room);
        order_.resize(std::max(order_.size(), room));
        index_.resize(room);
        for (std::vector<float>* column : {&dx_, &dy_, &dz_})
            column->resize(room + 1);
    }
    order_distances(distance2_.data(), near, ranks_.data(), order_.data());

    found_ = 0;
    dx_[0] = dy_[0] = dz_[0] = 0.0f;
    for (std::size_t r = 0; r < near && found_ < count_; ++r) {
        const std::uint32_t place = places_[order_[r]];
        if (gathered_[place] == query) continue;
        index_[found_++] = gathered_[place];
        dx_[found_] = x_[place] - from.x;
        dy_[found_] = y_[place] - from.y;
        dz_[found_] = z_[place] - from.z;
    }
    area_per_point_ = distance2_[order_[std::min(near, wanted) - 1]] / static_cast<float>(wanted);
    largest_area_ = std::max(largest_area_, area_per_point_);
    return true;
}

/// Leaves the `wanted` nearest of the places found, ascending; returns how many that are.
std::size_t NearestSearch::thin(std::size_t near, std::size_t wanted) {
    order_.resize(std::max(order_.size(), near));
    const auto begin = order_.begin(), middle = begin + static_cast<std::ptrdiff_t>(wanted);
    std::iota(begin, begin + static_cast<std::ptrdiff_t>(near), 0u);
    std::nth_element(begin, middle, begin + static_cast<std::ptrdiff_t>(near),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return distance2_[a] < distance2_[b] ||
                                (distance2_[a] == distance2_[b] && a < b);
                     });
    std::sort(begin, middle);
    for (std::size_t i = 0; i < wanted; ++i) {
        places_[i] = places_[order_[i]];
        distance2_[i] = distance2_[order_[i]];
    }
    return wanted;
}

std::vector<std::uint32_t> nearest_neighbours(const PointTree& tree, int count, float radius) {
    const auto stride = static_cast<std::size_t>(count);
    std::vector<std::uint32_t> rows(tree.size() * stride, kNoNeighbour);
    for_each_neighbourhood(tree, count, radius, [&](std::uint32_t i, const Neighbours& near) {
        std::ranges::copy(near.index, rows.begin() + static_cast<std::ptrdiff_t>(i * stride));
    });
    return rows;
}

}  // namespace glowworm
