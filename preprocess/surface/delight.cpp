#include "preprocess/surface/delight.h"

#include <tbb/parallel_sort.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "octree/morton.h"

namespace glowworm {
namespace {

/// Edge of a place that stations share, in median surfel radii, and surfels that each must have.
constexpr double kPlace = 12.0;
constexpr std::uint32_t kFewestSurfels = 3;

/// Fewer shared places than this for each unknown are no fit.
constexpr std::size_t kPairsPerUnknown = 20;

/// Standard error of an exponent above which the overlap does not determine it.
constexpr double kVagueExponent = 0.15;

/// Colours darker or brighter than this (linear) are cut off and say nothing; cosines below the
/// third are the normal's error more than the incidence.
constexpr double kDarkest = 0.002, kBrightest = 0.98, kGrazing = 0.15;

/// Differences of logarithms larger than this many times the median weigh less (Huber).
constexpr double kHuber = 2.0;

struct View {
    double log_distance, log_cosine;
};

/// How its station saw a surfel; false where it has none.
bool view_of(const SurfelCloud& cloud, const Surfel& surfel, View& view) {
    if (surfel.station >= cloud.stations.size()) return false;
    const Station& station = cloud.stations[surfel.station];
    if (!station.has_viewpoint) return false;
    const Vec3d toward = station.position - cloud.origin - vec3_cast<double>(surfel.position);
    const double distance = length(toward);
    if (!(distance > 1e-3)) return false;
    const double cosine = dot(toward, vec3_cast<double>(surfel.normal)) / distance;
    view = {std::log(distance), std::log(std::max(cosine, kGrazing))};
    return true;
}

double luminance(const Vec3f& c) {
    return (static_cast<double>(c.x) + c.y + c.z) / 3.0;
}

/// What one surfel adds to its place.
struct Sample {
    std::uint64_t place;
    std::uint32_t station;
    std::uint32_t surfel;
    float log_colour, log_distance, log_cosine;
};

/// Mean of a station's samples of a place.
struct Seen {
    std::uint32_t station = 0, count = 0;
    double log_colour = 0.0, log_distance = 0.0, log_cosine = 0.0;
};

/// Two stations' views of one place.
struct Pair {
    std::uint32_t a, b;
    double colour, distance, cosine;  // differences of logarithms, a minus b
};

double median_radius(const SurfelCloud& cloud) {
    std::vector<float> radii;
    const std::size_t every = std::max<std::size_t>(cloud.surfels.size() / 65536, 1);
    for (std::size_t i = 0; i < cloud.surfels.size(); i += every)
        radii.push_back(cloud.surfels[i].radius);
    if (radii.empty()) return 0.0;
    const auto middle = radii.begin() + static_cast<std::ptrdiff_t>(radii.size() / 2);
    std::nth_element(radii.begin(), middle, radii.end());
    return *middle;
}

/// Samples sorted by place, station and surfel. A place is a cell and one of six directions, so
/// that the two sides of a thin wall are two places.
std::vector<Sample> sorted_samples(const SurfelCloud& cloud) {
    std::vector<Sample> samples;
    const double cell = std::max(kPlace * median_radius(cloud), 1e-6);
    Vec3f low{};
    if (!cloud.surfels.empty()) low = cloud.surfels[0].position;
    for (const Surfel& surfel : cloud.surfels)
        low = component_min(low, surfel.position);
    for (std::size_t i = 0; i < cloud.surfels.size(); ++i) {
        const Surfel& surfel = cloud.surfels[i];
        View view{};
        const double colour = luminance(surfel.albedo);
        if (colour < kDarkest || colour > kBrightest || !view_of(cloud, surfel, view)) continue;
        if (view.log_cosine <= std::log(kGrazing)) continue;
        const Vec3d at = (vec3_cast<double>(surfel.position) - vec3_cast<double>(low)) / cell;
        constexpr double kCells = 262143.0;  // 18 bits an axis leave room for the direction
        const auto place_on = [&](double x) {
            return static_cast<std::uint32_t>(std::min(x, kCells));
        };
        const Vec3f& n = surfel.normal;
        int axis = std::abs(n.x) > std::abs(n.y) ? 0 : 1;
        if (std::abs(n.z) > std::abs(n[axis])) axis = 2;
        const auto side = static_cast<std::uint64_t>(2 * axis + (n[axis] < 0.0f));
        const std::uint64_t code = morton_encode({place_on(at.x), place_on(at.y), place_on(at.z)});
        samples.push_back({code << 3 | side, surfel.station, static_cast<std::uint32_t>(i),
                           static_cast<float>(std::log(colour)),
                           static_cast<float>(view.log_distance),
                           static_cast<float>(view.log_cosine)});
    }
    tbb::parallel_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
        if (a.place != b.place) return a.place < b.place;
        return a.station != b.station ? a.station < b.station : a.surfel < b.surfel;
    });
    return samples;
}

/// Each place's stations in turn.
std::vector<Pair> shared_places(const std::vector<Sample>& samples) {
    std::vector<Pair> pairs;
    std::vector<Seen> seen;
    for (std::size_t i = 0; i < samples.size();) {
        const std::uint64_t place = samples[i].place;
        seen.clear();
        while (i < samples.size() && samples[i].place == place) {
            Seen mean{samples[i].station};
            for (; i < samples.size() && samples[i].place == place &&
                   samples[i].station == mean.station;
                 ++i) {
                ++mean.count;
                mean.log_colour += samples[i].log_colour;
                mean.log_distance += samples[i].log_distance;
                mean.log_cosine += samples[i].log_cosine;
            }
            mean.log_colour /= mean.count;
            mean.log_distance /= mean.count;
            mean.log_cosine /= mean.count;
            if (mean.count >= kFewestSurfels) seen.push_back(mean);
        }
        for (std::size_t s = 1; s < seen.size(); ++s) {
            const Seen& a = seen[s - 1];
            const Seen& b = seen[s];
            pairs.push_back({a.station, b.station, a.log_colour - b.log_colour,
                             a.log_distance - b.log_distance, a.log_cosine - b.log_cosine});
        }
    }
    return pairs;
}

/// The fit: p, q, and a gain for each station (natural logarithm, their mean 0).
struct Falloff {
    double p = 0.0, q = 0.0;
    double p_error = 0.0, q_error = 0.0;  // standard errors
    std::vector<double> gains;
    double rms_before = 0.0, rms_after = 0.0;
};

/// Iteratively reweighted least squares over the normal equations.
Falloff fit_falloff(const std::vector<Pair>& pairs, std::size_t stations) {
    const auto unknowns = static_cast<Eigen::Index>(stations) + 2;
    const auto residual = [](const Pair& pair, const Eigen::VectorXd& x) {
        return pair.colour -
               (x[pair.a + 2] - x[pair.b + 2] - x[0] * pair.distance + x[1] * pair.cosine);
    };
    Eigen::VectorXd x = Eigen::VectorXd::Zero(unknowns);
    Eigen::MatrixXd normal;
    double scale = 1e30, spread = 0.0;
    std::vector<double> sizes(pairs.size());
    for (int step = 0; step < 8; ++step) {
        normal = Eigen::MatrixXd::Zero(unknowns, unknowns);
        Eigen::VectorXd right = Eigen::VectorXd::Zero(unknowns);
        double weights = 0.0;
        spread = 0.0;
        for (const Pair& pair : pairs) {
            const double r = residual(pair, x);
            const double w = std::abs(r) > kHuber * scale ? kHuber * scale / std::abs(r) : 1.0;
            const Eigen::Index at[4] = {0, 1, pair.a + 2, pair.b + 2};
            const double row[4] = {-pair.distance, pair.cosine, 1.0, -1.0};
            for (int i = 0; i < 4; ++i) {
                right[at[i]] += w * row[i] * pair.colour;
                for (int j = 0; j < 4; ++j)
                    normal(at[i], at[j]) += w * row[i] * row[j];
            }
            weights += w;
            spread += w * r * r;
        }
        spread /= std::max(weights, 1.0);
        // Only differences of gains are seen: hold their sum, and those of stations without pairs.
        const double hold = 1e-6 * static_cast<double>(pairs.size());
        for (Eigen::Index g = 2; g < unknowns; ++g)
            normal(g, g) += hold;
        normal(0, 0) += 1e-12;
        normal(1, 1) += 1e-12;
        x = normal.ldlt().solve(right);
        for (std::size_t k = 0; k < pairs.size(); ++k)
            sizes[k] = std::abs(residual(pairs[k], x));
        const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
        std::nth_element(sizes.begin(), middle, sizes.end());
        scale = std::max(*middle, 1e-9);
    }
    const Eigen::MatrixXd covariance = spread * normal.inverse();
    Falloff fit;
    fit.p = x[0];
    fit.q = x[1];
    fit.p_error = std::sqrt(std::max(covariance(0, 0), 0.0));
    fit.q_error = std::sqrt(std::max(covariance(1, 1), 0.0));
    for (Eigen::Index g = 2; g < unknowns; ++g)
        fit.gains.push_back(x[g]);
    double before = 0.0, after = 0.0;
    for (const Pair& pair : pairs) {
        before += pair.colour * pair.colour;
        after += residual(pair, x) * residual(pair, x);
    }
    fit.rms_before = std::sqrt(before / static_cast<double>(pairs.size()));
    fit.rms_after = std::sqrt(after / static_cast<double>(pairs.size()));
    return fit;
}

/// Divides the fitted falloff out; the median of the brightness stays.
void apply(const Falloff& fit, SurfelCloud& cloud) {
    const auto log_light = [&](const Surfel& surfel, double& light) {
        View view{};
        if (!view_of(cloud, surfel, view)) return false;
        light = fit.gains[surfel.station] - fit.p * view.log_distance + fit.q * view.log_cosine;
        return true;
    };
    std::vector<double> before, after;
    const std::size_t every = std::max<std::size_t>(cloud.surfels.size() / 65536, 1);
    for (std::size_t i = 0; i < cloud.surfels.size(); i += every) {
        double light = 0.0;
        const double colour = luminance(cloud.surfels[i].albedo);
        if (!(colour > 0.0) || !log_light(cloud.surfels[i], light)) continue;
        before.push_back(std::log(colour));
        after.push_back(std::log(colour) - light);
    }
    const auto median = [](std::vector<double>& values) {
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
        std::nth_element(values.begin(), middle, values.end());
        return *middle;
    };
    const double level = before.empty() ? 0.0 : median(before) - median(after);
    for (Surfel& surfel : cloud.surfels) {
        double light = 0.0;
        if (!log_light(surfel, light)) continue;
        const Vec3f bright = surfel.albedo * static_cast<float>(std::exp(level - light));
        surfel.albedo = component_min(bright, Vec3f{1.0f, 1.0f, 1.0f});
    }
}

}  // namespace

DelightReport delight(SurfelCloud& cloud) {
    DelightReport report;
    const std::vector<Pair> pairs = shared_places(sorted_samples(cloud));
    report.pairs = pairs.size();
    if (pairs.size() < kPairsPerUnknown * (cloud.stations.size() + 2)) {
        report.reason =
            "Stations with a known place share too little surface for the falloff of their light "
            "to be told from the albedo; the colours stay as they are.";
        return report;
    }
    const Falloff fit = fit_falloff(pairs, cloud.stations.size());
    if (!(fit.p_error < kVagueExponent && fit.q_error < kVagueExponent)) {
        report.reason =
            "The stations saw what they share from too much the same distances and angles for the "
            "falloff of their light to be known; the colours stay as they are.";
        return report;
    }
    apply(fit, cloud);
    report.distance_exponent = fit.p;
    report.incidence_exponent = fit.q;
    report.rms_before = fit.rms_before;
    report.rms_after = fit.rms_after;
    report.applied = true;
    return report;
}

}  // namespace glowworm
