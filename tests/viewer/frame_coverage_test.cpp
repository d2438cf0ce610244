// Which pixels a surface covers, and at which depth: against formulas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>
#include <random>

#include "camera_at.h"
#include "octree/build.h"
#include "viewer/frame/frame.h"
#include "viewer/gpu/context.h"

namespace glowworm {
namespace {

using ::testing::IsEmpty;

constexpr Vec3d kLow{-2.0, -1.5, 0.0}, kHigh{2.0, 1.5, 2.4};
constexpr int kWidth = 56, kHeight = 42;
constexpr double kDensity = 500;  // points per m2 of the rooms

Surfel surfel_at(const Vec3d& position, const Vec3d& normal, double density) {
    Surfel surfel;
    surfel.position = vec3_cast<float>(position);
    surfel.normal = vec3_cast<float>(normal);
    surfel.radius = static_cast<float>(std::sqrt(1.0 / (std::numbers::pi * density)));
    surfel.albedo = {0.5f, 0.5f, 0.5f};
    return surfel;
}

/// The faces of a box, points at random (not evenly: with gaps), `noise` m off along the normal.
/// `outward`: +1 where it is a body seen from outside, -1 for a room.
SurfelCloud box_of(const Vec3d& low, const Vec3d& high, double outward, double density,
                   double noise) {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::normal_distribution<double> off(0.0, noise > 0 ? noise : 1.0);
    SurfelCloud cloud;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const double area = (high[u] - low[u]) * (high[v] - low[v]);
        for (const double side : {-1.0, 1.0}) {
            for (int i = 0; i < static_cast<int>(area * density); ++i) {
                Vec3d normal{}, position{};
                normal[axis] = side * outward;
                position[axis] = side < 0 ? low[axis] : high[axis];
                if (noise > 0) position[axis] += off(random);
                position[u] = low[u] + unit(random) * (high[u] - low[u]);
                position[v] = low[v] + unit(random) * (high[v] - low[v]);
                cloud.surfels.push_back(surfel_at(position, normal, density));
            }
        }
    }
    return cloud;
}

SurfelCloud sphere_of(const Vec3d& centre, double radius, double density) {
    std::mt19937 random(12);
    std::normal_distribution<double> any(0.0, 1.0);
    SurfelCloud cloud;
    const double area = 4.0 * std::numbers::pi * radius * radius;
    for (int i = 0; i < static_cast<int>(area * density); ++i) {
        const Vec3d normal = normalized(Vec3d{any(random), any(random), any(random)});
        cloud.surfels.push_back(surfel_at(centre + normal * radius, normal, density));
    }
    return cloud;
}

View view_from(const Vec3d& eye, const Vec3d& look_at, int width = kWidth, int height = kHeight) {
    return view_of(testing::camera_at(eye, look_at, 70.0, width, height));
}

/// Depth at which a ray meets a box, from inside where it leaves it; nothing where it misses.
std::optional<double> box_depth(const ViewRay& ray, const Vec3d& low, const Vec3d& high) {
    double enter = -1e30, leave = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = (low[axis] - ray.origin[axis]) / ray.direction[axis];
        const double b = (high[axis] - ray.origin[axis]) / ray.direction[axis];
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
    if (enter > leave || leave <= 0) return std::nullopt;
    return enter > 0 ? enter : leave;
}

std::optional<double> sphere_depth(const ViewRay& ray, const Vec3d& centre, double radius) {
    const Vec3d to = centre - ray.origin;
    const double a = dot(ray.direction, ray.direction), b = dot(to, ray.direction);
    const double under_root = b * b - a * (dot(to, to) - radius * radius);
    if (under_root < 0) return std::nullopt;
    return (b - std::sqrt(under_root)) / a;
}

struct Drawn {
    Context context = Context::headless();
    Octree octree;
    LightField light;
    Frame frame;

    explicit Drawn(SurfelCloud cloud)
        : octree(build_octree(std::move(cloud), {.depth = 4})),
          light(context, octree.view(), {}),
          frame(context, octree.view(), {.selection = {}, .samples = 1}) {}

    std::vector<float> depths(const View& view) {
        const FrameLayers layers = frame.render(view, light);
        EXPECT_THAT(context.errors(), IsEmpty());
        return layers.depth;
    }
};

struct DepthErrors {
    std::size_t holes = 0;
    double mean = 0, worst = 0;  // m
    double worst_off = 0;        // m: from the nearest wall of the point that is shown
};

double distance_to_room(const Vec3d& point) {
    double nearest = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
        nearest = std::min(
            {nearest, std::abs(point[axis] - kLow[axis]), std::abs(point[axis] - kHigh[axis])});
    }
    return nearest;
}

DepthErrors errors_in_room(Drawn& room, const View& view) {
    DepthErrors errors;
    const std::vector<float> depths = room.depths(view);
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const double depth = depths[static_cast<std::size_t>(y * view.width + x)];
            if (depth <= 0) {
                ++errors.holes;
                continue;
            }
            const ViewRay ray = ray_through(view, x + 0.5, y + 0.5);
            const double truth = *box_depth(ray, kLow, kHigh);
            const double off =
                distance_to_room(ray.origin + ray.direction * static_cast<double>(depth));
            errors.worst_off = std::max(errors.worst_off, off);
            errors.mean += std::abs(depth - truth) / static_cast<double>(depths.size());
            errors.worst = std::max(errors.worst, std::abs(depth - truth));
        }
    }
    return errors;
}

TEST(Coverage, LeavesNoHoleInAClosedRoomOfRandomNoisyPointsSeenFromTwentyPlaces) {
    for (const double noise : {0.0, 0.01}) {
        Drawn room(box_of(kLow, kHigh, -1, kDensity, noise));
        std::mt19937 random(3);
        std::uniform_real_distribution<double> x(-1.8, 1.8), y(-1.3, 1.3), z(0.2, 2.2), any(-1, 1);
        DepthErrors all;
        const int places = noise > 0 ? 8 : 20;
        for (int i = 0; i < places; ++i) {
            Vec3d eye{x(random), y(random), z(random)};
            Vec3d ahead = normalized(Vec3d{any(random), any(random), any(random)});
            if (i % 4 == 1) eye.x = -1.9;  // 10 cm from a wall
            if (i % 4 == 2) {
                eye.y = 1.45;  // along it, 5 cm off
                ahead = normalized(Vec3d{any(random), 0.05, 0.2 * any(random)});
            }
            const DepthErrors errors = errors_in_room(room, view_from(eye, eye + ahead));
            all.holes += errors.holes;
            all.mean += errors.mean / places;
            all.worst = std::max(all.worst, errors.worst);
            all.worst_off = std::max(all.worst_off, errors.worst_off);
        }
        std::cout << "noise " << noise << " m: " << all.holes << " holes, depth error mean "
                  << 1e3 * all.mean << " mm, worst " << 1e3 * all.worst
                  << " mm, there and everywhere " << 1e3 * all.worst_off
                  << " mm off a wall at most\n";
        EXPECT_EQ(all.holes, 0u);
        EXPECT_LT(all.mean, 0.003 + 2.0 * noise) << "m";
        // Along a wall 5 cm off the eye a centimetre is half a metre of depth: what is shown there
        // lies on the wall nevertheless, within the points' spacing.
        EXPECT_LT(all.worst_off, 1.0 / std::sqrt(kDensity) + 2.0 * noise) << "m";
    }
}

TEST(Coverage, ShowsAWallTenCentimetresAwayAtItsDepth) {
    Drawn room(box_of(kLow, kHigh, -1, 800, 0.0));
    for (const Vec3d& ahead : {Vec3d{-1, 0, 0}, Vec3d{-1, 0.6, 0.3}}) {
        const Vec3d eye{-1.9, 0.2, 1.1};
        const DepthErrors errors = errors_in_room(room, view_from(eye, eye + ahead));
        std::cout << "10 cm from a wall: depth error mean " << 1e3 * errors.mean << " mm, worst "
                  << 1e3 * errors.worst << " mm\n";
        EXPECT_EQ(errors.holes, 0u);
        EXPECT_LT(errors.mean, 0.001) << "m";
    }
}

TEST(Coverage, KeepsTheColourOfADarkWallWhereOnlyTheOuterPartOfADiscReaches) {
    SurfelCloud cloud = box_of(kLow, kHigh, -1, 150, 0.0);
    for (Surfel& surfel : cloud.surfels)
        surfel.albedo = {0.004f, 0.012f, 0.03f};
    Drawn room(std::move(cloud));
    double worst = 0;
    for (const Vec3d& ahead : {Vec3d{1, 0.2, 0.1}, Vec3d{-0.3, 1, -0.4}}) {
        const View view = view_from({-1.5, -1.2, 1.1}, Vec3d{-1.5, -1.2, 1.1} + ahead, 160, 120);
        const FrameLayers layers = room.frame.render(view, room.light);
        const Vec3f first = layers.albedo.front();
        EXPECT_NEAR(first.z, 0.03f, 0.002f);
        for (const Vec3f& albedo : layers.albedo) {
            for (int channel = 0; channel < 3; ++channel) {
                worst = std::max(worst, std::abs(static_cast<double>(albedo[channel]) /
                                                     static_cast<double>(first[channel]) -
                                                 1.0));
            }
        }
    }
    std::cout << "a dark wall's colour is off by " << 1e2 * worst << " % at worst\n";
    EXPECT_LT(worst, 0.2);
}

/// Of pixels on the other side of the true outline, the distance in pixels to the nearest that is
/// right: the farthest, and the mean over the outline's pixels.
struct OutlineError {
    double worst = 0, mean = 0;
};

template <typename Truth>
OutlineError outline_error(const std::vector<float>& depths, const View& view, const Truth& truth) {
    const auto covered = [&](int x, int y) {
        return truth(ray_through(view, x + 0.5, y + 0.5)).has_value();
    };
    OutlineError error;
    int wrong = 0;
    for (int y = 0; y < view.height; ++y) {
        for (int x = 0; x < view.width; ++x) {
            const bool drawn = depths[static_cast<std::size_t>(y * view.width + x)] > 0;
            if (drawn == covered(x, y)) continue;
            double nearest = 1e30;
            for (int j = std::max(y - 8, 0); j < std::min(y + 9, view.height); ++j) {
                for (int i = std::max(x - 8, 0); i < std::min(x + 9, view.width); ++i) {
                    if (covered(i, j) == drawn)
                        nearest = std::min(nearest, std::hypot(i - x, j - y));
                }
            }
            ++wrong;
            error.worst = std::max(error.worst, nearest);
            error.mean += nearest;
        }
    }
    if (wrong > 0) error.mean /= wrong;
    return error;
}

TEST(Coverage, DrawsOutlinesWithinTwoPixels) {
    // 1.3 pixels from point to point.
    const View view = view_from({0, -3, 0.4}, {0, 0, 0}, 160, 120);
    const double metre = view.focal / 3.0;
    const double density = metre * metre / 1.7;
    Drawn sphere(sphere_of({0, 0, 0}, 1.0, density));
    const OutlineError round = outline_error(
        sphere.depths(view), view, [](const ViewRay& ray) { return sphere_depth(ray, {}, 1.0); });
    const Vec3d low{-0.8, -0.5, -0.6}, high{0.7, 0.6, 0.5};
    Drawn box(box_of(low, high, 1, density, 0.0));
    const OutlineError straight = outline_error(
        box.depths(view), view, [&](const ViewRay& ray) { return box_depth(ray, low, high); });
    std::cout << "wrong pixels lie off the outline by: sphere " << round.mean << " in the mean, "
              << round.worst << " at worst; box " << straight.mean << ", " << straight.worst
              << " pixels\n";
    EXPECT_LE(round.worst, 2.0);
    EXPECT_LE(straight.worst, 2.0);
}

}  // namespace
}  // namespace glowworm
