#include "viewer/app/photometry.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glowworm {

using std::numbers::pi;

double luminance_of(const Vec3f& rgb) {
    return 0.2126 * rgb.x + 0.7152 * rgb.y + 0.0722 * rgb.z;
}

Vec3f color_of_temperature(double kelvin) {
    const double t = std::clamp(kelvin, 1667.0, 25000.0);
    const double u = 1e3 / t;
    const double x = t < 4000.0 ? ((-0.2661239 * u - 0.2343589) * u + 0.8776956) * u + 0.179910
                                : ((-3.0258469 * u + 2.1070379) * u + 0.2226347) * u + 0.240390;
    const double y = t < 2222.0 ? ((-1.1063814 * x - 1.34811020) * x + 2.18555832) * x - 0.20219683
                     : t < 4000.0
                         ? ((-0.9549476 * x - 1.37418593) * x + 2.09137015) * x - 0.16748867
                         : ((3.0817580 * x - 5.87338670) * x + 3.75112997) * x - 0.37001483;
    // xyY with Y = 1 to Rec.709 (IEC 61966-2-1).
    const double X = x / y, Z = (1.0 - x - y) / y;
    const Vec3d rgb{3.2404542 * X - 1.5371385 - 0.4985314 * Z,
                    -0.9692660 * X + 1.8760108 + 0.0415560 * Z,
                    0.0556434 * X - 0.2040259 + 1.0572252 * Z};
    const Vec3f shown = vec3_cast<float>(component_max(rgb, Vec3d{}));
    return shown / static_cast<float>(luminance_of(shown));
}

double power_of(const PointLight& light) {
    return 4.0 * pi * luminance_of(light.radiant_intensity);
}

double power_of(const SpotLight& light) {
    return spot_solid_angle(light.cone_deg, light.blend) * luminance_of(light.radiant_intensity);
}

double power_of(const AreaLight& light) {
    return pi * area_of(light) * luminance_of(light.radiance);
}

double spot_solid_angle(double cone_deg, double blend) {
    // Over c = cos(theta): a ramp c·(3t² − 2t³) from the edge on, then a plateau up to the axis.
    const double edge = std::cos(cone_deg * pi / 360.0);
    const double ramp = (1.0 - edge) * blend, top = edge + ramp;
    return 2.0 * pi * (ramp * (edge / 2.0 + ramp * 7.0 / 20.0) + (1.0 - top * top) / 2.0);
}

double area_of(const AreaLight& light) {
    return length(cross(light.corners[1] - light.corners[0], light.corners[3] - light.corners[0]));
}

}  // namespace glowworm
