// Measuring, photometry and picking against formulas.
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "camera_at.h"
#include "testing.h"
#include "viewer/app/measure.h"
#include "viewer/app/photometry.h"
#include "viewer/app/pick.h"

namespace glowworm {
namespace {

using std::numbers::pi;

TEST(Measure, GivesTheCaversTripleInEveryQuadrant) {
    const struct {
        Vec3d to;
        double bearing, inclination;
    } cases[] = {{{0, 5, 0}, 0, 0},
                 {{5, 0, 0}, 90, 0},
                 {{0, -5, 0}, 180, 0},
                 {{-5, 0, 0}, 270, 0},
                 {{1, 1, std::sqrt(2.0)}, 45, 45},
                 {{-3, 3, 0}, 315, 0},
                 {{0, 0, 2}, 0, 90},
                 {{0, 0, -2}, 0, -90}};
    for (const auto& c : cases) {
        const SurveyLeg leg = leg_between({10, 20, 30}, Vec3d{10, 20, 30} + c.to);
        EXPECT_NEAR(leg.bearing_deg, c.bearing, 1e-9);
        EXPECT_NEAR(leg.inclination_deg, c.inclination, 1e-9);
        EXPECT_NEAR(leg.distance, length(c.to), 1e-9);
        EXPECT_NEAR(leg.height, c.to.z, 1e-9);
    }
    EXPECT_EQ(leg_between({1, 1, 1}, {1, 1, 1}).distance, 0.0);
}

TEST(Measure, KnowsLengthsAndAreas) {
    EXPECT_EQ(polyline_length({}), 0.0);
    EXPECT_EQ(polygon_area({}), 0.0);
    const std::vector<Vec3d> square{{0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
    EXPECT_NEAR(polyline_length(square), 6.0, 1e-12);
    EXPECT_NEAR(polygon_area(square), 4.0, 1e-12);
    const std::vector<Vec3d> notched{{0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {1, 1, 0}, {0, 3, 0}};
    EXPECT_NEAR(polygon_area(notched), 6.0, 1e-12) << "by the shoelace formula";
    // Tilted by 60 degrees about X.
    std::vector<Vec3d> tilted;
    for (const Vec3d& p : square)
        tilted.push_back({p.x, p.y * 0.5, p.y * std::sqrt(0.75)});
    EXPECT_NEAR(polygon_area(tilted), 4.0, 1e-12);
}

TEST(Measure, WritesWhatItMeasuredAsJson) {
    const std::vector<Measurement> list{{MeasureKind::kLeg, {{0, 0, 0}, {3, 0, 4}}},
                                        {MeasureKind::kPolygon, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}};
    const auto json = nlohmann::json::parse(measurements_json(list));
    EXPECT_EQ(json["measurements"][0]["length_m"], 5.0);
    EXPECT_EQ(json["measurements"][0]["bearing_deg"], 90.0);
    EXPECT_EQ(json["measurements"][0]["points"][1][2], 4.0);
    EXPECT_EQ(json["measurements"][1]["area_m2"], 0.5);
    EXPECT_THAT(measurement_text(list[0]), ::testing::HasSubstr("5.000 m"));
}

TEST(Photometry, MakesWarmLightOfLowTemperaturesAndWhiteOfDaylight) {
    const Vec3f candle = color_of_temperature(1900), bulb = color_of_temperature(2856),
                day = color_of_temperature(6504);
    EXPECT_GT(candle.x / candle.z, bulb.x / bulb.z);
    EXPECT_GT(bulb.x / bulb.z, 3.0f);
    // D65 is Rec.709's white; a black body of its temperature is a little pinker.
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(day[c], 1.0f, 0.06f) << c;
    for (double kelvin = 1000; kelvin < 30000; kelvin += 500) {
        const Vec3f color = color_of_temperature(kelvin);
        EXPECT_NEAR(luminance_of(color), 1.0, 1e-5);
        EXPECT_GE(std::min({color.x, color.y, color.z}), 0.0f);
    }
    // CIE illuminant A, x = 0.44757, y = 0.40745, through the Rec.709 matrix.
    EXPECT_NEAR(bulb.x, 1.8451, 0.02);
    EXPECT_NEAR(bulb.y, 0.8261, 0.02);
    EXPECT_NEAR(bulb.z, 0.2333, 0.02);
}

TEST(Photometry, IntegratesASpotAsItsFalloffSays) {
    for (const double cone : {10.0, 45.0, 90.0, 180.0}) {
        for (const double blend : {0.0, 0.15, 1.0}) {
            const double edge = std::cos(cone * pi / 360);
            const int n = 200000;
            double sum = 0;
            for (int i = 0; i < n; ++i) {
                const double c = edge + (1 - edge) * (i + 0.5) / n;
                const double t =
                    std::clamp((c - edge) / std::max((1 - edge) * blend, 1e-12), 0.0, 1.0);
                sum += c * t * t * (3 - 2 * t) * (1 - edge) / n;
            }
            EXPECT_NEAR(spot_solid_angle(cone, blend) / (2 * pi * sum), 1.0, 1e-4)
                << cone << " " << blend;
        }
    }
    EXPECT_NEAR(power_of(PointLight{"", {}, {1, 1, 1}}), 4 * pi, 1e-5);
    const AreaLight panel{"", {{0, 0, 0}, {2, 0, 0}, {2, 0.5, 0}, {0, 0.5, 0}}, {3, 3, 3}};
    EXPECT_NEAR(power_of(panel), 3 * pi, 1e-5);
}

TEST(Pick, FindsWhereTheCursorsRayMeetsTheWallWhateverPixelItIsIn) {
    const View view = view_of(testing::camera_at({1, 2, 3}, {1, 7, 3}, 60, 40, 30));
    // A tilted wall through (1, 6, 3); each pixel knows its depth at its middle.
    const Vec3d normal = normalized(Vec3d{0.5, -1, 0.3}), through{1, 6, 3};
    double worst = 0;
    for (double x = 0.1; x < 40; x += 3.7) {
        for (double y = 0.2; y < 30; y += 3.1) {
            const ViewRay middle = ray_through(view, std::floor(x) + 0.5, std::floor(y) + 0.5);
            const double depth =
                dot(through - middle.origin, normal) / dot(middle.direction, normal);
            const gpu::vec4 surface{float(normal.x), float(normal.y), float(normal.z),
                                    float(depth)};
            const auto point = surface_point(view, surface, x, y);
            ASSERT_TRUE(point);
            worst = std::max(worst, std::abs(dot(point->position - through, normal)));
            const PixelPoint seen = project(view, point->position);
            worst = std::max({worst, std::abs(seen.x - x), std::abs(seen.y - y)});
        }
    }
    std::cout << "worst difference " << worst << " (m, pixels)\n";
    EXPECT_LT(worst, 1e-5);
    EXPECT_FALSE(surface_point(view, {0, 0, 0, 0}, 5, 5));
}

}  // namespace
}  // namespace glowworm
