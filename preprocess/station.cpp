#include "preprocess/station.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "preprocess/depth_image.h"

namespace glowworm {
namespace {

/// A gap in depth wider than this many cell widths is not one slanted surface.
constexpr float kFarInCellWidths = 10.0f;
constexpr double kFinestCellDeg = 0.15, kCoarsestCellDeg = 2.5;
constexpr std::size_t kEnoughPoints = 1000, kFewestPoints = 30;
constexpr std::size_t kSubset = 200000;  // points that tell enough
constexpr float kAside = 0.2f;           // of the median range

struct Sample {
    std::uint32_t cell;
    float depth;
    bool operator<(const Sample& o) const {
        return cell != o.cell ? cell < o.cell : depth < o.depth;
    }
};

}  // namespace

HiddenShare hidden_share(const Points& points, double cell_deg) {
    const CubeMap map(static_cast<std::uint32_t>(std::lround(90.0 / cell_deg)));
    std::vector<Sample> samples;
    samples.reserve(points.size());
    for (const Vec3f& p : points.positions) {
        const float depth = length(p);
        if (std::isfinite(depth) && depth > 0.0f) samples.push_back({map.cell(p), depth});
    }
    tbb::parallel_sort(samples.begin(), samples.end());

    const float cell_width = static_cast<float>(cell_deg) * 0.0174533f;
    std::size_t hidden = 0, shared = 0;
    for (std::size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
        bool behind = false;
        for (end = begin; end < samples.size() && samples[end].cell == samples[begin].cell; ++end) {
            const float gap = end == begin ? 0.0f : samples[end].depth - samples[end - 1].depth;
            behind = behind || gap > kFarInCellWidths * cell_width * samples[end].depth;
            hidden += behind ? 1 : 0;
        }
        if (end - begin > 1) shared += end - begin;
    }
    return {shared == 0 ? 0.0 : static_cast<double>(hidden) / static_cast<double>(shared), shared};
}

bool origin_is_viewpoint(const Points& points) {
    Points seen;
    std::vector<float> ranges;
    const std::size_t stride = std::max<std::size_t>(1, points.size() / kSubset);
    for (std::size_t i = 0; i < points.size(); i += stride) {
        if (!is_finite(points.positions[i])) continue;
        seen.positions.push_back(points.positions[i]);
        ranges.push_back(length(points.positions[i]));
    }
    // The finest cells in which enough points meet: the finer, the sharper the two cases part.
    HiddenShare hidden;
    double cell_deg = kFinestCellDeg;
    for (; cell_deg < kCoarsestCellDeg; cell_deg *= 2.0) {
        hidden = hidden_share(seen, cell_deg);
        if (hidden.points >= kEnoughPoints) break;
    }
    if (hidden.points < kFewestPoints || hidden.share >= kHiddenShareLimit) return false;
    if (hidden.share < kSurelySeen) return true;

    // From a place beside a scanner more is hidden, but from some place beside an origin that lies
    // in the same chamber as the scanner less is.
    const auto median = ranges.begin() + static_cast<std::ptrdiff_t>(ranges.size() / 2);
    std::nth_element(ranges.begin(), median, ranges.end());
    for (const int axis : {0, 1, 2}) {
        for (const float step : {-kAside * *median, kAside * *median}) {
            Points aside = seen;
            for (Vec3f& p : aside.positions)
                p[axis] += step;
            if (hidden_share(aside, cell_deg).share < kMoreAside * hidden.share) return false;
        }
    }
    return true;
}

}  // namespace glowworm
