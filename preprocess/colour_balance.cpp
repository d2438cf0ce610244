#include "preprocess/colour_balance.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "octree/pack.h"

namespace glowworm {
namespace {

constexpr int kRounds = 6;                      // of reweighting
constexpr double kHuber = 0.1;                  // log units, about 10 %
constexpr std::uint32_t kFewest = 3;            // points of a station in a cell
constexpr double kDark = 0.003, kBright = 0.9;  // linear: nothing can be told beyond
constexpr double kMostGain = 2.0;

double to_linear(std::uint8_t code) {
    return static_cast<double>(srgb_to_linear(static_cast<float>(code) / 255.0f));
}

std::uint8_t to_srgb(double linear) {
    const float l = static_cast<float>(std::clamp(linear, 0.0, 1.0));
    return static_cast<std::uint8_t>(std::lround(255.0f * linear_to_srgb(l)));
}

struct CellPoint {
    std::uint64_t cell;
    std::uint32_t station, index;
    bool operator<(const CellPoint& o) const {
        if (cell != o.cell) return cell < o.cell;
        return station != o.station ? station < o.station : index < o.index;
    }
};

/// Two stations that saw the same cell, and log(colour of a / colour of b) there.
struct Comparison {
    std::uint32_t a, b;
    std::array<double, 3> log_ratio;
};

std::vector<Comparison> compare_cells(const Points& points, double edge) {
    Vec3f low = points.positions.front();
    for (const Vec3f& p : points.positions)
        low = component_min(low, p);
    std::vector<CellPoint> sorted(points.size());
    tbb::parallel_for(
        std::uint32_t{0}, static_cast<std::uint32_t>(points.size()), [&](std::uint32_t i) {
            const Vec3d d =
                (vec3_cast<double>(points.positions[i]) - vec3_cast<double>(low)) / edge;
            // Beyond 2²¹ cells they fold onto others: a few comparisons more among millions.
            const auto part = [](double c) { return static_cast<std::uint64_t>(c) & 0x1FFFFF; };
            sorted[i] = {part(d.z) << 42 | part(d.y) << 21 | part(d.x), points.stations[i], i};
        });
    tbb::parallel_sort(sorted.begin(), sorted.end());

    struct Mean {
        std::uint32_t station;
        std::array<double, 3> colour;
    };
    std::vector<Comparison> comparisons;
    std::vector<Mean> means;  // of the cell at hand
    for (std::size_t begin = 0, end = 0; begin < sorted.size(); begin = end) {
        if (begin == 0 || sorted[begin].cell != sorted[begin - 1].cell) means.clear();
        std::array<double, 3> sum{};
        for (end = begin; end < sorted.size() && sorted[end].cell == sorted[begin].cell &&
                          sorted[end].station == sorted[begin].station;
             ++end) {
            const Rgb8 c = points.colours[sorted[end].index];
            sum[0] += to_linear(c.r), sum[1] += to_linear(c.g), sum[2] += to_linear(c.b);
        }
        if (end - begin < kFewest) continue;
        for (double& s : sum)
            s /= static_cast<double>(end - begin);
        if (*std::min_element(sum.begin(), sum.end()) < kDark) continue;
        if (*std::max_element(sum.begin(), sum.end()) > kBright) continue;
        for (const Mean& other : means) {
            Comparison c{sorted[begin].station, other.station, {}};
            for (std::size_t k = 0; k < 3; ++k)
                c.log_ratio[k] = std::log(sum[k] / other.colour[k]);
            comparisons.push_back(c);
        }
        means.push_back({sorted[begin].station, sum});
    }
    return comparisons;
}

}  // namespace

std::vector<Vec3d> colour_gains(const Points& points, std::size_t stations, double cell) {
    std::vector<Vec3d> gains(stations, Vec3d{1.0, 1.0, 1.0});
    if (points.colours.empty() || points.stations.empty() || stations < 2) return gains;
    const std::vector<Comparison> comparisons = compare_cells(points, cell);
    if (comparisons.empty()) return gains;
    const auto n = static_cast<Eigen::Index>(stations);
    for (int channel = 0; channel < 3; ++channel) {
        Eigen::VectorXd gain = Eigen::VectorXd::Zero(n);  // log
        for (int round = 0; round < kRounds; ++round) {
            // A whiff of a pull to 0 holds the mean and the stations that overlap nobody.
            const double pull =
                1e-3 * static_cast<double>(comparisons.size()) / static_cast<double>(n);
            Eigen::MatrixXd A = pull * Eigen::MatrixXd::Identity(n, n);
            Eigen::VectorXd b = Eigen::VectorXd::Zero(n);
            for (const Comparison& c : comparisons) {
                const double ratio = c.log_ratio[static_cast<std::size_t>(channel)];
                const double residual = ratio + gain[c.a] - gain[c.b];
                const double weight = std::min(1.0, kHuber / std::max(std::abs(residual), 1e-12));
                A(c.a, c.a) += weight;
                A(c.b, c.b) += weight;
                A(c.a, c.b) -= weight;
                A(c.b, c.a) -= weight;
                b[c.a] -= weight * ratio;
                b[c.b] += weight * ratio;
            }
            gain = A.ldlt().solve(b);
            gain.array() -= gain.mean();
        }
        for (Eigen::Index i = 0; i < n; ++i) {
            gains[static_cast<std::size_t>(i)][channel] =
                std::clamp(std::exp(gain[i]), 1.0 / kMostGain, kMostGain);
        }
    }
    return gains;
}

void apply_gains(Points& points, const std::vector<Vec3d>& gains) {
    if (points.colours.empty() || points.stations.empty()) return;
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
        const Vec3d& gain = gains[points.stations[i]];
        Rgb8& c = points.colours[i];
        c = {to_srgb(gain.x * to_linear(c.r)), to_srgb(gain.y * to_linear(c.g)),
             to_srgb(gain.z * to_linear(c.b))};
    });
}

}  // namespace glowworm
