#include "preprocess/read/scan_facts.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace glowworm {
namespace {

constexpr std::size_t kMostSampled = std::size_t{1} << 18;
constexpr std::size_t kSpread = 64;
constexpr std::size_t kBlockPoints = 65536;

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

std::uint64_t hash_of(const Vec3d& p) {
    // Adding zero makes one of the two zeros.
    const std::uint64_t x = std::bit_cast<std::uint64_t>(p.x + 0.0);
    const std::uint64_t y = std::bit_cast<std::uint64_t>(p.y + 0.0);
    const std::uint64_t z = std::bit_cast<std::uint64_t>(p.z + 0.0);
    return mixed(mixed(mixed(x + 0x9e3779b97f4a7c15u) + y) + z);
}

bool is_float(double v) {
    return static_cast<double>(static_cast<float>(v)) == v;
}

/// Points [begin, end) of `scan` as a block, its offset left out.
void fill_block(const Scan& scan, std::size_t begin, std::size_t end, PointBlock& block) {
    const Points& points = scan.points;
    block.resize(end - begin, {.colours = !points.colours.empty()});
    for (std::size_t i = begin; i < end; ++i) {
        block.positions[i - begin] = vec3_cast<double>(points.positions[i]);
        if (!points.colours.empty()) block.colours[i - begin] = points.colours[i];
    }
}

}  // namespace

void FactsCollector::add(const PointBlock& block, const Vec3d& origin) {
    if (block.size() == 0) return;
    if (points_ == 0) low_ = high_ = origin + block.positions[0];
    points_ += block.size();
    for (const Vec3d& relative : block.positions) {
        const Vec3d p = origin + relative;
        low_ = component_min(low_, p);
        high_ = component_max(high_, p);
        on_float_grid_ = on_float_grid_ && is_float(p.x) && is_float(p.y) && is_float(p.z);
        const std::uint64_t hash = hash_of(p);
        if (hash <= hash_limit_) sampled_hashes_.push_back(hash);
        if (spread_.size() < kSpread || hash < spread_.front().first) {
            const auto by_hash = [](const auto& a, const auto& b) { return a.first < b.first; };
            if (spread_.size() == kSpread) {
                std::ranges::pop_heap(spread_, by_hash);
                spread_.pop_back();
            }
            spread_.emplace_back(hash, p);
            std::ranges::push_heap(spread_, by_hash);
        }
        while (sampled_hashes_.size() > kMostSampled) {
            hash_limit_ /= 2;
            std::erase_if(sampled_hashes_, [this](std::uint64_t h) { return h > hash_limit_; });
            if (hash_limit_ == 0) break;  // a stack of one point with the least hash
        }
    }
    for (const GridCell& cell : block.grid) {
        grid_rows_ = std::max(grid_rows_, std::uint64_t{cell.row} + 1);
        grid_columns_ = std::max(grid_columns_, std::uint64_t{cell.column} + 1);
    }
    for (const Rgb8& c : block.colours) {
        has_colours_ = true;
        darkest_ = {std::min(darkest_.r, c.r), std::min(darkest_.g, c.g),
                    std::min(darkest_.b, c.b)};
        brightest_ = {std::max(brightest_.r, c.r), std::max(brightest_.g, c.g),
                      std::max(brightest_.b, c.b)};
    }
}

void FactsCollector::finish(ScanFacts& facts) {
    facts.low = low_;
    facts.high = high_;
    facts.has_colours = has_colours_;
    facts.darkest = has_colours_ ? darkest_ : Rgb8{};
    facts.brightest = brightest_;
    facts.grid_rows = grid_rows_;
    facts.grid_columns = grid_columns_;
    facts.on_float_grid = on_float_grid_;
    std::ranges::sort(sampled_hashes_);
    // Not std::ranges::unique: clang 14 cannot compile what it returns.
    const auto distinct = std::unique(sampled_hashes_.begin(), sampled_hashes_.end());
    if (!sampled_hashes_.empty()) {
        facts.duplicate_share = static_cast<double>(sampled_hashes_.end() - distinct) /
                                static_cast<double>(sampled_hashes_.size());
    }
}

std::vector<Vec3d> FactsCollector::spread_points() const {
    std::vector<Vec3d> points;
    for (const auto& [hash, point] : spread_)
        points.push_back(point);
    return points;
}

SpacingCollector::SpacingCollector(std::vector<Vec3d> queries)
    : queries_(std::move(queries)),
      squared_(queries_.size(), std::numeric_limits<double>::infinity()) {}

void SpacingCollector::add(const std::vector<Vec3d>& positions, const Vec3d& origin) {
    for (std::size_t i = 0; i < queries_.size(); ++i) {
        const Vec3d query = queries_[i] - origin;
        double nearest = squared_[i];
        for (const Vec3d& p : positions) {
            const Vec3d d = p - query;
            const double squared = dot(d, d);
            if (squared < nearest && squared > 0.0) nearest = squared;
        }
        squared_[i] = nearest;
    }
}

double SpacingCollector::median() const {
    std::vector<double> found;
    for (const double squared : squared_) {
        if (std::isfinite(squared)) found.push_back(std::sqrt(squared));
    }
    if (found.empty()) return 0.0;
    const auto middle = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
    std::nth_element(found.begin(), middle, found.end());
    return *middle;
}

ScanFacts facts_of(const Scan& scan, const ScanCounts& counts) {
    ScanFacts facts;
    facts.counts = counts;
    facts.has_pose = scan.T_world_scan.has_value();
    facts.crs = scan.crs;
    FactsCollector collector;
    PointBlock block;
    const auto for_each_block = [&](auto visit) {
        for (std::size_t begin = 0; begin < scan.points.size(); begin += kBlockPoints) {
            fill_block(scan, begin, std::min(begin + kBlockPoints, scan.points.size()), block);
            visit();
        }
    };
    for_each_block([&] { collector.add(block, scan.offset); });
    collector.finish(facts);
    SpacingCollector spacing(collector.spread_points());
    for_each_block([&] { spacing.add(block.positions, scan.offset); });
    facts.spacing = spacing.median();
    return facts;
}

}  // namespace glowworm
