#include "octree/splat.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <vector>

namespace glowworm {
namespace {

struct DiscPoint {
    double u, v;  ///< in disc radii
};

constexpr std::uint32_t pieces_of(std::uint32_t rings) {
    return 1 + 3 * rings * (rings + 1);
}

/// Pieces of equal area: one in the middle, then rings of 6, 12, 18, ... each at the radius that
/// halves its ring's area. Built from square roots alone, so the same on every host.
std::vector<DiscPoint> disc_pattern(std::uint32_t rings) {
    constexpr double kHalfRoot3 = 0.5 * std::numbers::sqrt3;
    constexpr DiscPoint kHexagon[7] = {{1.0, 0.0},  {0.5, kHalfRoot3},   {-0.5, kHalfRoot3},
                                       {-1.0, 0.0}, {-0.5, -kHalfRoot3}, {0.5, -kHalfRoot3},
                                       {1.0, 0.0}};
    const double pieces = pieces_of(rings);
    std::vector<DiscPoint> points{{0.0, 0.0}};
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
        const double radius = std::sqrt((pieces_of(ring - 1) + 3.0 * ring) / pieces);
        for (std::uint32_t side = 0; side < 6; ++side) {
            for (std::uint32_t step = 0; step < ring; ++step) {
                const double t = static_cast<double>(step) / ring;
                const DiscPoint a = kHexagon[side], b = kHexagon[side + 1];
                const double u = a.u + (b.u - a.u) * t, v = a.v + (b.v - a.v) * t;
                const double scale = radius / std::sqrt(u * u + v * v);
                points.push_back({u * scale, v * scale});
            }
        }
    }
    return points;
}

/// The pieces of a disc, and what they are on the whole.
struct Pattern {
    std::vector<DiscPoint> points;  ///< of all pieces, the middle first
    std::vector<DiscPoint> half;    ///< without the middle and what lies opposite to another
    double spread = 0.0;            ///< mean of u², which is that of v²; that of u·v is 0
};

Pattern pattern_with(std::uint32_t rings) {
    Pattern pattern{disc_pattern(rings), {}, 0.0};
    for (std::uint32_t ring = 1; ring <= rings; ++ring) {
        const auto first = pattern.points.begin() + pieces_of(ring - 1);
        pattern.half.insert(pattern.half.end(), first, first + 3 * ring);
    }
    for (const DiscPoint& point : pattern.points)
        pattern.spread += point.u * point.u / pieces_of(rings);
    return pattern;
}

const std::array<Pattern, kMaxSplatRings + 1> kPatterns = [] {
    std::array<Pattern, kMaxSplatRings + 1> all;
    for (std::uint32_t i = 0; i <= kMaxSplatRings; ++i)
        all[i] = pattern_with(i);
    return all;
}();

constexpr std::uint32_t kMaxSmallRings = 2;  ///< a bit for each piece fits a PieceSet
constexpr PieceSet kCounted = 1u << 31;      ///< else: pieces in bits 8..15, the first in 0..7

constexpr PieceSet all_of(std::uint32_t pieces) {
    return (1u << pieces) - 1u;
}

/// Of a coordinate that is not negative; std::floor would be a call into the maths library.
std::uint32_t floor_of(double v) {
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(v));
}

CellIndex leaf_at(const Vec3d& at) {
    return {floor_of(at.x), floor_of(at.y), floor_of(at.z)};
}

Vec3d corner_of(const CellIndex& cell) {
    return {static_cast<double>(cell.x), static_cast<double>(cell.y), static_cast<double>(cell.z)};
}

/// How many leaves on from the one whose lower corner it is counted from: -1, 0 or 1.
int step_of(double coordinate) {
    return static_cast<int>(coordinate >= 1.0) - static_cast<int>(coordinate < 0.0);
}

/// Adds weight · p pᵀ to the xx, yy, zz, xy, xz, yz of a matrix.
void add_square(double (&sum)[6], const Vec3d& p, double weight) {
    sum[0] += weight * p.x * p.x;
    sum[1] += weight * p.y * p.y;
    sum[2] += weight * p.z * p.z;
    sum[3] += weight * p.x * p.y;
    sum[4] += weight * p.x * p.z;
    sum[5] += weight * p.y * p.z;
}

}  // namespace

Splat splat_of(double radius) {
    constexpr double kWiden = 2.0;  // at one sample a voxel face: 1.5 loses four times the light
    constexpr double kRootPi = std::numbers::pi * std::numbers::inv_sqrtpi;
    Splat splat;
    splat.radius = radius * std::clamp(kWiden * kRootPi * radius, 1.0, 2.0);
    // Pieces are sqrt(pi R² / n) apart; a quarter of a voxel at most, or leaves that no sample of a
    // random cloud falls into would be holes: 1 in 70 at 4 samples a face.
    const double needed = 16.0 * std::numbers::pi * splat.radius * splat.radius;
    while (splat.pieces < needed && splat.rings < kMaxSplatRings) {
        splat.pieces = pieces_of(++splat.rings);
    }
    return splat;
}

LeafGrid::LeafGrid(const Grid& grid)
    : cube_min(vec3_cast<double>(grid.cube_min)),
      leaves(static_cast<double>(std::uint64_t{1} << grid.depth)) {
    // Powers of two of what Grid::finest_coordinates counts with.
    const double finest = static_cast<double>(std::uint64_t{1} << kMortonLevels);
    leaves_per_metre = finest / grid.cube_edge * (leaves / finest);
    last = (finest - 1.0 / 65536.0) * (leaves / finest);
}

Disc::Disc(const Surfel& surfel, const LeafGrid& grid)
    : grid_(grid),
      splat_(splat_of(surfel.radius * grid.leaves_per_metre)),
      centre_(grid.at(surfel.position)),
      leaf_(leaf_at(centre_)) {
    if (splat_.rings == 0) return;
    // Without branches (Duff et al. 2017, Building an Orthonormal Basis, Revisited).
    const Vec3d n = vec3_cast<double>(surfel.normal);
    const double sign = n.z < 0.0 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + n.z);
    const double b = n.x * n.y * a;
    u_ = Vec3d{1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x} * splat_.radius;
    v_ = Vec3d{b, sign + n.y * n.y * a, -n.y} * splat_.radius;
}

Vec3d Disc::at(std::uint32_t piece) const {
    const DiscPoint& point = kPatterns[splat_.rings].points[piece];
    const double last = grid_.last;
    const Vec3d free = centre_ + u_ * point.u + v_ * point.v;
    return component_max({}, component_min({last, last, last}, free));
}

bool Disc::is_inside_one_leaf() const {
    if (splat_.rings == 0) return true;
    const Vec3d at = centre_ - corner_of(leaf_);
    return std::min({at.x, at.y, at.z}) >= splat_.radius &&
           std::max({at.x, at.y, at.z}) <= 1.0 - splat_.radius;
}

bool Disc::is_inside_cube() const {
    return std::min({centre_.x, centre_.y, centre_.z}) >= splat_.radius &&
           std::max({centre_.x, centre_.y, centre_.z}) < grid_.leaves - splat_.radius;
}

std::size_t Disc::cut(DiscParts& parts) const {
    if (is_inside_one_leaf()) {
        parts[0] = {leaf_, all_of(splat_.pieces)};
        return 1;
    }
    return splat_.rings <= kMaxSmallRings && is_inside_cube() ? cut_small(parts) : cut_any(parts);
}

std::size_t Disc::cut_small(DiscParts& parts) const {
    constexpr int kOwn = 13;
    const std::vector<DiscPoint>& points = kPatterns[splat_.rings].points;
    const Vec3d at = centre_ - corner_of(leaf_);
    std::array<int, pieces_of(kMaxSmallRings)> neighbour;  // 0..26 of each piece
    PieceSet others = 0;
    for (std::uint32_t i = 1; i < splat_.pieces; ++i) {
        const Vec3d p = at + u_ * points[i].u + v_ * points[i].v;
        neighbour[i] = kOwn + step_of(p.x) + 3 * step_of(p.y) + 9 * step_of(p.z);
        if (neighbour[i] != kOwn) others |= 1u << i;
    }
    parts[0] = {leaf_, all_of(splat_.pieces) & ~others};
    std::size_t count = 1;
    while (others != 0) {
        const int there = neighbour[static_cast<std::size_t>(std::countr_zero(others))];
        PieceSet pieces = 0;
        for (PieceSet left = others; left != 0; left &= left - 1) {
            const int i = std::countr_zero(left);
            if (neighbour[static_cast<std::size_t>(i)] == there) pieces |= 1u << i;
        }
        const auto moved = [](std::uint32_t cell, int step) {
            return static_cast<std::uint32_t>(static_cast<int>(cell) + step);
        };
        parts[count++] = {{moved(leaf_.x, there % 3 - 1), moved(leaf_.y, there / 3 % 3 - 1),
                           moved(leaf_.z, there / 9 - 1)},
                          pieces};
        others &= ~pieces;
    }
    return count;
}

std::size_t Disc::cut_any(DiscParts& parts) const {
    struct Piece {
        std::uint64_t order;  ///< the surfel's own leaf before all others
        std::uint32_t index;
    };
    std::array<Piece, kMaxPieces> pieces;
    const std::uint64_t own = morton_encode(leaf_);
    for (std::uint32_t i = 0; i < splat_.pieces; ++i) {
        const std::uint64_t code = morton_encode(leaf_at(at(i)));
        pieces[i] = {code == own ? 0 : code + 1, i};
    }
    const auto end = pieces.begin() + splat_.pieces;
    std::sort(pieces.begin(), end, [](const Piece& a, const Piece& b) {
        return a.order != b.order ? a.order < b.order : a.index < b.index;
    });
    std::size_t count = 0;
    for (auto first = pieces.begin(); first != end;) {
        auto past = first + 1;
        while (past != end && past->order == first->order)
            ++past;
        parts[count++] = {first->order == 0 ? leaf_ : morton_decode(first->order - 1),
                          kCounted | static_cast<PieceSet>(past - first) << 8 | first->index};
        first = past;
    }
    return count;
}

PieceMoments Disc::moments_of(const DiscPart& part) const {
    const Pattern& pattern = kPatterns[splat_.rings];
    const Vec3d leaf_centre = corner_of(part.leaf) + Vec3d{0.5, 0.5, 0.5};
    const Vec3d centre = centre_ - leaf_centre;
    PieceMoments moments;
    if (splat_.rings <= kMaxSmallRings && part.pieces == all_of(splat_.pieces)) {
        // The pattern turns into itself: its mean is the centre, its spread is round.
        Vec3d reach;
        for (const DiscPoint& point : pattern.half) {
            const Vec3d offset = u_ * point.u + v_ * point.v;
            reach = component_max(reach, component_max(offset, -offset));
        }
        moments.mean = centre;
        add_square(moments.products, centre, 1.0);
        add_square(moments.products, u_, pattern.spread);
        add_square(moments.products, v_, pattern.spread);
        moments.lower = centre - reach;
        moments.upper = centre + reach;
        moments.share = 1.0;
        return moments;
    }

    Vec3d sum;
    double products[6] = {};
    moments.lower = {1.0, 1.0, 1.0};
    moments.upper = {-1.0, -1.0, -1.0};
    const auto add = [&](const Vec3d& p) {
        sum += p;
        add_square(products, p, 1.0);
        moments.lower = component_min(moments.lower, p);
        moments.upper = component_max(moments.upper, p);
    };
    std::uint32_t count = 0;
    if ((part.pieces & kCounted) == 0) {
        count = static_cast<std::uint32_t>(std::popcount(part.pieces));
        for (PieceSet left = part.pieces; left != 0; left &= left - 1) {
            const DiscPoint& point =
                pattern.points[static_cast<std::size_t>(std::countr_zero(left))];
            add(centre + u_ * point.u + v_ * point.v);
        }
    } else {
        count = part.pieces >> 8 & 0xff;
        std::uint32_t left = count;
        for (std::uint32_t i = part.pieces & 0xff; left > 0; ++i) {
            const Vec3d there = at(i);
            if (!(leaf_at(there) == part.leaf)) continue;
            add(there - leaf_centre);
            --left;
        }
    }
    const double each = 1.0 / count;
    moments.mean = sum * each;
    for (int i = 0; i < 6; ++i)
        moments.products[i] = products[i] * each;
    moments.share = static_cast<double>(count) / splat_.pieces;
    return moments;
}

void Disc::add_to(LeafSums& sums, const Surfel& surfel, const DiscPart& part) const {
    const PieceMoments moments = moments_of(part);
    LobeSample sample;
    sample.ndf = vec3_cast<double>(surfel.normal) * static_cast<double>(surfel.ndf_length);
    sample.albedo = vec3_cast<double>(surfel.albedo);
    sample.emission = vec3_cast<double>(surfel.emission);
    sample.area = std::numbers::pi * surfel.radius * surfel.radius * moments.share;
    sample.surfels = moments.share;
    sample.light = surfel.light;
    sums.add_pieces(sample, moments);
}

}  // namespace glowworm
