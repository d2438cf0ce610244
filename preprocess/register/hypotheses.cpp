#include "preprocess/register/hypotheses.h"

#include <tbb/parallel_for.h>

#include <Eigen/SVD>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace glowworm {
namespace {

constexpr float kAngleTolerance = 0.25f;  // of cosines
constexpr float kNormalsAgree = 0.8f;     // cosine
constexpr std::size_t kGrownFrom = 30;    // partners a seed is fitted with
constexpr double kSameTurn = 0.1;         // radians: guesses nearer than this are one
constexpr double kSameShift = 3.0;        // in tolerances

/// A correspondence's two ends.
struct Match {
    Eigen::Vector3f p, n, q, m;  // source position and normal, target position and normal
};

bool compatible(const Match& a, const Match& b, float tolerance, bool upright) {
    const Eigen::Vector3f d = b.p - a.p, e = b.q - a.q;
    const float ld = d.norm(), le = e.norm();
    if (std::abs(ld - le) > tolerance) return false;
    if (std::min(ld, le) < 2.0f * tolerance) return false;  // too close to say anything
    if (upright && std::abs(d.z() - e.z()) > tolerance) return false;
    return std::abs(a.n.dot(b.n) - a.m.dot(b.m)) < kAngleTolerance &&
           std::abs(a.n.dot(d) / ld - a.m.dot(e) / le) < kAngleTolerance &&
           std::abs(b.n.dot(d) / ld - b.m.dot(e) / le) < kAngleTolerance;
}

/// Who is compatible with whom: a symmetric matrix of bits.
class Compatibility {
  public:
    Compatibility(std::span<const Match> matches, float tolerance, bool upright)
        : words_((matches.size() + 63) / 64), bits_(matches.size() * words_) {
        tbb::parallel_for(std::size_t{0}, matches.size(), [&](std::size_t i) {
            std::uint64_t* row = &bits_[i * words_];
            for (std::size_t j = 0; j < matches.size(); ++j) {
                if (i != j && compatible(matches[i], matches[j], tolerance, upright)) {
                    row[j / 64] |= std::uint64_t{1} << (j % 64);
                }
            }
        });
    }
    std::size_t shared(std::size_t i, std::size_t j) const {
        std::size_t count = 0;
        for (std::size_t w = 0; w < words_; ++w) {
            count += static_cast<std::size_t>(
                std::popcount(bits_[i * words_ + w] & bits_[j * words_ + w]));
        }
        return count;
    }
    std::size_t degree(std::size_t i) const { return shared(i, i); }
    bool has(std::size_t i, std::size_t j) const {
        return (bits_[i * words_ + j / 64] >> (j % 64) & 1) != 0;
    }

  private:
    std::size_t words_;
    std::vector<std::uint64_t> bits_;
};

std::vector<std::uint32_t> inliers_of(const Eigen::Isometry3d& T, std::span<const Match> matches,
                                      float tolerance) {
    const Eigen::Isometry3f Tf = T.cast<float>();
    const Eigen::Matrix3f R = Tf.linear();
    std::vector<std::uint32_t> inliers;
    for (std::uint32_t i = 0; i < matches.size(); ++i) {
        if ((Tf * matches[i].p - matches[i].q).squaredNorm() > tolerance * tolerance) continue;
        if ((R * matches[i].n).dot(matches[i].m) > kNormalsAgree) inliers.push_back(i);
    }
    return inliers;
}

std::vector<Match> ends_of(const Keypoints& source, const Keypoints& target,
                           std::span<const Correspondence> correspondences) {
    std::vector<Match> matches;
    for (const Correspondence& c : correspondences) {
        matches.push_back({to_eigen(source.positions[c.source]), to_eigen(source.normals[c.source]),
                           to_eigen(target.positions[c.target]),
                           to_eigen(target.normals[c.target])});
    }
    return matches;
}

Eigen::Isometry3d fit(std::span<const Match> matches, std::span<const std::uint32_t> chosen,
                      bool upright) {
    std::vector<Vec3f> source, target;
    for (const std::uint32_t i : chosen) {
        source.push_back(to_vec3(matches[i].p));
        target.push_back(to_vec3(matches[i].q));
    }
    return fit_motion(source, target, upright);
}

bool same(const Eigen::Isometry3d& A, const Eigen::Isometry3d& B, const Eigen::Vector3d& where,
          double tolerance) {
    const Eigen::AngleAxisd turn(A.rotation().transpose() * B.rotation());
    return turn.angle() < kSameTurn && (A * where - B * where).norm() < kSameShift * tolerance;
}

}  // namespace

std::size_t count_agreeing(const Keypoints& source, const Keypoints& target,
                           std::span<const Correspondence> matches,
                           const Eigen::Isometry3d& T_target_source, double tolerance) {
    return inliers_of(T_target_source, ends_of(source, target, matches),
                      static_cast<float>(tolerance))
        .size();
}

Eigen::Isometry3d fit_motion(std::span<const Vec3f> source, std::span<const Vec3f> target,
                             bool upright) {
    const double n = static_cast<double>(source.size());
    Eigen::Vector3d p = Eigen::Vector3d::Zero(), q = p;
    for (std::size_t i = 0; i < source.size(); ++i) {
        p += to_eigen(source[i]).cast<double>() / n;
        q += to_eigen(target[i]).cast<double>() / n;
    }
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < source.size(); ++i) {
        covariance += (to_eigen(source[i]).cast<double>() - p) *
                      (to_eigen(target[i]).cast<double>() - q).transpose();
    }
    Eigen::Matrix3d R;
    if (upright) {
        const double yaw =
            std::atan2(covariance(0, 1) - covariance(1, 0), covariance(0, 0) + covariance(1, 1));
        R = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    } else {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                                    Eigen::ComputeFullU | Eigen::ComputeFullV);
        Eigen::Matrix3d U = svd.matrixU();
        const Eigen::Matrix3d V = svd.matrixV();
        // A turn, never a mirror image.
        if ((V * U.transpose()).determinant() < 0.0) U.col(2) = -U.col(2);
        R = V * U.transpose();
    }
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = R;
    T.translation() = q - R * p;
    return T;
}

std::vector<Hypothesis> hypothesize(const Keypoints& source, const Keypoints& target,
                                    std::span<const Correspondence> correspondences,
                                    const HypothesisSettings& settings) {
    std::vector<Match> matches = ends_of(source, target, correspondences);
    if (settings.upright) {
        std::erase_if(matches, [](const Match& match) {
            return std::abs(match.n.z() - match.m.z()) > kAngleTolerance;
        });
    }
    if (matches.size() < settings.fewest_inliers) return {};
    const float tolerance = static_cast<float>(settings.tolerance);
    const Compatibility compatibility(matches, tolerance, settings.upright);

    // Seeds: those with most compatible partners first.
    std::vector<std::size_t> degrees(matches.size());
    for (std::size_t i = 0; i < matches.size(); ++i)
        degrees[i] = compatibility.degree(i);
    std::vector<std::uint32_t> seeds(matches.size());
    std::iota(seeds.begin(), seeds.end(), 0u);
    std::stable_sort(seeds.begin(), seeds.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return degrees[a] > degrees[b]; });

    std::vector<Hypothesis> found;
    std::vector<std::uint8_t> explained(matches.size());
    std::size_t tried = 0;
    for (const std::uint32_t seed : seeds) {
        if (degrees[seed] + 1 < settings.fewest_inliers || tried == settings.max_seeds) break;
        if (explained[seed]) continue;
        ++tried;
        std::vector<std::pair<std::size_t, std::uint32_t>> partners;  // shared partners, who
        for (std::uint32_t j = 0; j < matches.size(); ++j) {
            if (compatibility.has(seed, j)) partners.push_back({compatibility.shared(seed, j), j});
        }
        std::sort(partners.begin(), partners.end(), [](const auto& a, const auto& b) {
            return a.first != b.first ? a.first > b.first : a.second < b.second;
        });
        std::vector<std::uint32_t> chosen{seed};
        for (std::size_t k = 0; k < std::min(partners.size(), kGrownFrom); ++k) {
            if (2 * partners[k].first < partners[0].first) break;
            chosen.push_back(partners[k].second);
        }
        if (chosen.size() < 3) continue;
        Hypothesis guess{fit(matches, chosen, settings.upright), 0};
        std::vector<std::uint32_t> inliers;
        for (int round = 0; round < 3; ++round) {
            const float wide = round == 0 ? 1.5f * tolerance : tolerance;
            inliers = inliers_of(guess.T_target_source, matches, wide);
            if (inliers.size() < 3) break;
            guess.T_target_source = fit(matches, inliers, settings.upright);
        }
        inliers = inliers_of(guess.T_target_source, matches, tolerance);
        guess.inliers = inliers.size();
        if (guess.inliers < settings.fewest_inliers) continue;
        for (const std::uint32_t i : inliers)
            explained[i] = 1;
        found.push_back(guess);
    }

    std::stable_sort(found.begin(), found.end(), [](const Hypothesis& a, const Hypothesis& b) {
        return a.inliers > b.inliers;
    });
    std::vector<Hypothesis> distinct;
    const Eigen::Vector3d where = matches[seeds[0]].p.cast<double>();
    for (const Hypothesis& guess : found) {
        if (distinct.size() == settings.max_count) break;
        const bool known = std::any_of(distinct.begin(), distinct.end(), [&](const Hypothesis& h) {
            return same(h.T_target_source, guess.T_target_source, where, settings.tolerance);
        });
        if (!known) distinct.push_back(guess);
    }
    return distinct;
}

}  // namespace glowworm
