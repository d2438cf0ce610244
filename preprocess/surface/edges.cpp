#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "preprocess/surface/normals.h"
#include "preprocess/surface/plane_fit.h"

namespace glowworm {
namespace {

/// A neighbourhood this much thicker than the noise, and than this share of its extent, is bent too
/// sharply for one plane: a fold by more than some 30 degrees.
constexpr float kThickerThanNoise = 2.5f;
constexpr float kThicknessOfExtent = 0.14f;

/// Planes of neighbours that are tried for a face, at most.
constexpr std::size_t kTries = 12;

/// Points this many times the scale of the noise off a face are not of it.
constexpr float kReach = 4.0f;

/// Cosine between the normals of two faces beyond which they are one, bent.
constexpr double kOneFace = 0.9;

/// Fewest points that make a face, the weights of its fit summed.
constexpr double kFewest = 4.0;

/// Faces whose normals, both turned to where the point may be, are farther apart than this cosine
/// are the two sides of something thin: nothing lies between them.
constexpr double kThinThing = -0.3;

/// A point is this uncertain about the face that it is not of, of the scale of the noise: the
/// scanner's beam is slanted, and the face's plane is an estimate.
constexpr double kSlant = 0.7;

bool crosses_edge(const LocalPlane& plane, float noise) {
    const float extent2 =
        plane.area * static_cast<float>(plane.points) / (4.0f * std::numbers::pi_v<float>);
    return plane.area > 0.0f && plane.thickness > kThickerThanNoise * noise &&
           plane.thickness * plane.thickness > kThicknessOfExtent * kThicknessOfExtent * extent2;
}

/// A plane beside an edge, relative to the point in question.
struct Face {
    Vec3d normal;
    double offset = 0.0;  ///< m: of the plane from the point, along the normal
    double scale = 0.0;   ///< m: of the noise
    PlaneFit fit;         ///< to its points

    double height(const Vec3d& p) const { return dot(normal, p) - offset; }
};

/// Tukey's biweight: 1 on the face, 0 from its reach on.
double weight_on(const Face& face, const Vec3d& p) {
    const double u = face.height(p) / (kReach * face.scale);
    const double v = 1.0 - u * u;
    return v > 0.0 ? v * v : 0.0;
}

class EdgeFit {
  public:
    EdgeFit(const NormalSettings& settings, const std::vector<LocalPlane>& planes)
        : settings_(settings), planes_(planes) {}

    /// The plane of the face that a point is of, or between two where that is open; none (`edge`
    /// not set) where there is no face around that it could be of.
    LocalPlane fit(const Neighbours& near) {
        near_ = &near;
        const Vec3d last = offset(std::min(near.size(), static_cast<std::size_t>(settings_.k) - 1));
        near2_ = std::max(dot(last, last), 1e-18);
        const std::optional<Face> guess = best_face(nullptr);
        if (!guess) return {};
        const std::optional<Face> guess_beside = best_face(&*guess);
        const std::optional<Face> own = refine(*guess, guess_beside ? &*guess_beside : nullptr);
        if (!own) return {};
        const std::optional<Face> beside =
            guess_beside ? refine(*guess_beside, &*own) : std::nullopt;
        return beside ? between(*own, *beside) : to_plane(*own);
    }

  private:
    Vec3d offset(std::size_t n) const { return {near_->x[n], near_->y[n], near_->z[n]}; }

    /// What point n says about a face: the more the nearer it is to the one in question.
    double weight(const Face& face, std::size_t n) const {
        const Vec3d p = offset(n);
        return weight_on(face, p) / (1.0 + dot(p, p) / near2_);
    }

    /// Of the neighbours' planes in which the point lies the one with the most points; beside
    /// `other` if it is given, of the points that are not on that.
    std::optional<Face> best_face(const Face* other) {
        faces_.clear();
        for (std::size_t n = 0; n < near_->size(); ++n) {
            const LocalPlane& plane = planes_[near_->index[n]];
            if (!(plane.area > 0.0f)) continue;
            Face face;
            face.normal = vec3_cast<double>(plane.normal);
            face.offset = dot(face.normal, offset(n + 1)) + static_cast<double>(plane.height);
            face.scale = std::max({settings_.range_noise, plane.thickness, 1e-9f});
            if (std::abs(face.offset) > kReach * face.scale) continue;
            if (other && std::abs(dot(face.normal, other->normal)) > kOneFace) continue;
            faces_.push_back(face);
        }
        std::optional<Face> best;
        double most = 0.0;
        const std::size_t every = (faces_.size() + kTries - 1) / kTries;
        for (std::size_t f = 0; f < faces_.size(); f += every) {
            // Flat ones count more: a plane across the edge is near to many points of both faces.
            double sum = 0.0;
            for (std::size_t n = 0; n <= near_->size(); ++n) {
                if (!other || weight_on(*other, offset(n)) == 0.0) sum += weight(faces_[f], n);
            }
            sum /= faces_[f].scale * faces_[f].scale;
            if (sum > most) {
                most = sum;
                best = faces_[f];
            }
        }
        return best;
    }

    /// Fits the face to its points, those nearer to `other` left out; none where they are too few.
    std::optional<Face> refine(Face face, const Face* other) {
        for (int step = 0; step < 4; ++step) {
            Moments moments;
            for (std::size_t n = 0; n <= near_->size(); ++n) {
                const Vec3d p = offset(n);
                if (other && std::abs(other->height(p)) < std::abs(face.height(p))) continue;
                moments.add(p, weight(face, n));
            }
            face.fit = fit_plane(moments);
            if (!face.fit.is_planar() || face.fit.weight < kFewest) return std::nullopt;
            face.normal = face.fit.normal;
            face.offset = dot(face.fit.normal, face.fit.centre);
        }
        if (std::abs(face.offset) > kReach * face.scale) return std::nullopt;
        return face;
    }

    /// Noise takes points of one face beyond the other, so that the height over either says only
    /// how likely the point is of it: its normal is the mean of both, weighted by that.
    LocalPlane between(const Face& own, const Face& beside) const {
        // The sides on which the other face's points lie are where the point may be, too.
        double over_own = 0.0, over_beside = 0.0;
        for (std::size_t n = 0; n <= near_->size(); ++n) {
            const double a = own.height(offset(n)), b = beside.height(offset(n));
            if (std::abs(a) < std::abs(b)) {
                over_beside += b;
            } else {
                over_own += a;
            }
        }
        const double own_side = std::copysign(1.0, over_own);
        const double beside_side = std::copysign(1.0, over_beside);
        const double a = -own_side * own.offset, b = -beside_side * beside.offset;
        const double own_likely = likelihood(a / own.scale, b / own.scale);
        const double beside_likely = likelihood(b / beside.scale, a / beside.scale);
        const double both = own_likely + beside_likely;
        const double share = both > 0.0 ? beside_likely / both : 0.5;

        LocalPlane plane = to_plane(share > 0.5 ? beside : own);
        const Vec3d n = own.normal * own_side, m = beside.normal * beside_side;
        if (dot(n, m) < kThinThing) return plane;
        const Vec3d foot =
            own.normal * ((1.0 - share) * own.offset) + beside.normal * (share * beside.offset);
        const Vec3d normal = normalized(n * (1.0 - share) + m * share);
        plane.normal = vec3_cast<float>(normal);
        plane.height = static_cast<float>(dot(normal, foot));
        // What the choice leaves open turns the normal as noise does.
        const double doubt2 = 2.0 * (1.0 - dot(n, m)) * share * (1.0 - share);
        const double scatter = std::max<double>(plane.thickness, settings_.range_noise);
        plane.error_per_noise =
            static_cast<float>(std::sqrt(static_cast<double>(plane.error_per_noise) *
                                             static_cast<double>(plane.error_per_noise) +
                                         doubt2 / std::max(scatter * scatter, 1e-18)));
        return plane;
    }

    /// How likely a point of one of two faces lies `height` over it and `inside` the other, both in
    /// standard deviations of the noise.
    static double likelihood(double height, double inside) {
        return std::exp(-0.5 * height * height) / (1.0 + std::exp(-1.7 * inside / kSlant));
    }

    LocalPlane to_plane(const Face& face) const {
        Moments side;
        side.add({});
        const std::size_t nearest =
            std::min(near_->size(), static_cast<std::size_t>(settings_.k) - 1);
        for (std::size_t n = 1; n <= nearest; ++n) {
            if (weight_on(face, offset(n)) > 0.0) side.add(offset(n));
        }
        const double weight = face.fit.weight;
        LocalPlane plane;
        plane.normal = vec3_cast<float>(face.normal);
        plane.height = static_cast<float>(face.offset);
        plane.thickness = static_cast<float>(
            std::sqrt(face.fit.thickness2 * weight / std::max(weight - 3.0, 1.0)));
        plane.error_per_noise = static_cast<float>(face.fit.angle_error_per_noise());
        plane.area = static_cast<float>(area_per_point(fit_plane(side)));
        plane.points = static_cast<std::uint16_t>(side.weight);
        plane.edge = plane.area > 0.0f;
        return plane;
    }

    const NormalSettings& settings_;
    const std::vector<LocalPlane>& planes_;
    const Neighbours* near_ = nullptr;
    double near2_ = 0.0;  // m²: squared distance of the k-th point
    std::vector<Face> faces_;
};

}  // namespace

std::size_t sharpen_edges(const SurfacePoints& points, const NormalSettings& settings,
                          std::vector<LocalPlane>& planes) {
    // Read all before writing any, so that the order of the threads does not show.
    std::vector<std::uint32_t> candidates;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        if (crosses_edge(planes[i], settings.range_noise)) {
            candidates.push_back(static_cast<std::uint32_t>(i));
        }
    }
    std::vector<LocalPlane> sharp(candidates.size());
    const tbb::blocked_range<std::size_t> all(0, candidates.size(), 64);
    tbb::parallel_for(all, [&](const auto& range) {
        NearestSearch search(points.tree);
        EdgeFit fit(settings, planes);
        for (std::size_t c = range.begin(); c < range.end(); ++c) {
            // Where noise turns the normals both faces take more points.
            const LocalPlane& plane = planes[candidates[c]];
            const bool is_noisy =
                plane.error_per_noise * settings.range_noise > settings.slope_error;
            const int around = (is_noisy ? 2 : 1) * settings.k - 1;
            search.visit_nearest(
                {&candidates[c], 1}, around, settings.radius,
                [&](std::uint32_t, const Neighbours& near) { sharp[c] = fit.fit(near); });
        }
    });
    std::size_t fitted = 0;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
        if (!sharp[c].edge) continue;
        planes[candidates[c]] = sharp[c];
        ++fitted;
    }
    return fitted;
}

}  // namespace glowworm
