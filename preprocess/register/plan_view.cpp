#include "preprocess/register/plan_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "octree/error.h"
#include "preprocess/plot/lettering.h"
#include "preprocess/plot/map_marks.h"
#include "preprocess/register/scan_name.h"

namespace glowworm {
namespace {

constexpr double kMargin = 0.05;        // of the longer side
constexpr int kStationRadius = 6;       // pixels
constexpr int kFoot = 3 * kLineHeight;  // pixels below the map, for the scale bar
constexpr int kArrow = 48;              // pixels, its length
constexpr double kLongestBar = 0.3;     // of the map's longer side
constexpr std::size_t kLongestName = 32;
constexpr std::size_t kLooked = 20000;  // points per scan that the borders are found by
constexpr double kSure = 0.005;         // share of the points on each side that may be strays
constexpr double kGap = 0.02;           // of the width: what lies beyond such a gap is a stray
constexpr std::uint8_t kDark = 16;      // scans glow on a dark ground
constexpr Rgb8 kPaper{kDark, kDark, kDark}, kPale{200, 200, 200}, kRed{255, 96, 96},
    kWhite{255, 255, 255};

struct Placed {
    const Scan* scan;
    std::string name;
    Eigen::Isometry3f T_plan_scan;  ///< of the scan's positions
    Eigen::Vector3f station;
};

/// The scans of a plan, relative to the first station so that floats hold them.
struct Plan {
    std::vector<Placed> placed;
    std::vector<std::string> unplaced;
};

std::string shown_name(const Scan& scan) {
    std::string name = short_name(pose_file(scan));
    if (name.size() > kLongestName) name = "..." + name.substr(name.size() - kLongestName + 3);
    return name;
}

Plan plan_of(std::span<const Scan> scans, const Poses& poses) {
    Plan plan;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Scan& scan : scans) {
        const ScanPose* pose = find_pose(poses, scan);
        if (pose == nullptr || pose->status == PoseStatus::kUnregistered) {
            plan.unplaced.push_back(shown_name(scan));
            continue;
        }
        const Eigen::Isometry3d T =
            pose->T_world_scan * Eigen::Translation3d(scan.offset.x, scan.offset.y, scan.offset.z);
        if (plan.placed.empty()) middle = T.translation();
        plan.placed.push_back({&scan, shown_name(scan),
                               (Eigen::Translation3d(-middle) * T).cast<float>(),
                               (pose->T_world_scan.translation() - middle).cast<float>()});
    }
    return plan;
}

/// Colours far apart from one another: hues at the golden angle, light and dark in turn.
std::array<float, 3> scan_colour(std::size_t index) {
    const double hue = std::fmod(0.61803398875 * static_cast<double>(index), 1.0) * 6.0;
    const double pale = index % 2 == 0 ? 0.15 : 0.45;
    std::array<float, 3> colour;
    for (std::size_t k = 0; k < 3; ++k) {
        const double phase = std::fmod(hue + (k == 0 ? 0.0 : k == 1 ? 4.0 : 2.0), 6.0);
        const double full = std::clamp(std::abs(phase - 3.0) - 1.0, 0.0, 1.0);
        colour[k] = static_cast<float>(pale + (1.0 - pale) * full);
    }
    return colour;
}

/// A picture on which points add up to light until it is developed.
struct Canvas : Picture {
    Canvas(int columns, int rows) : Picture(columns, rows, kPaper), light(pixels.size()) {}

    void add(int x, int y, const std::array<float, 3>& colour) {
        if (!holds(x, y)) return;
        Light& sum = light[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(x)];
        for (std::size_t k = 0; k < 3; ++k)
            sum.colour[k] += colour[k];
        sum.points += 1.0f;
    }

    /// The mean colour of a pixel's points, as bright as 1 - exp(-exposure · points): places that
    /// many scans saw do not fade to white.
    void develop(float exposure) {
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (light[i].points == 0.0f) continue;
            const float bright =
                (255.0f - kDark) * (1.0f - std::exp(-exposure * light[i].points)) / light[i].points;
            const auto code = [&](std::size_t k) {
                return static_cast<std::uint8_t>(kDark + std::lround(bright * light[i].colour[k]));
            };
            pixels[i] = {code(0), code(1), code(2)};
        }
    }

    void disc(int x, int y, int radius, Rgb8 colour) {
        for (int v = -radius; v <= radius; ++v) {
            const int half = static_cast<int>(std::sqrt(radius * radius - v * v));
            fill(x - half, y + v, 2 * half + 1, 1, colour);
        }
    }

    struct Light {
        std::array<float, 3> colour{};
        float points = 0;
    };
    std::vector<Light> light;
};

Rgb8 as_code(const std::array<float, 3>& colour) {
    const auto code = [](float c) { return static_cast<std::uint8_t>(std::lround(255.0f * c)); };
    return {code(colour[0]), code(colour[1]), code(colour[2])};
}

struct Range {
    double low = 0, high = 0;
    double length() const { return high - low; }
};

/// From where to where points follow one another: all but strays far outside.
Range shown_range(std::vector<float> values) {
    std::sort(values.begin(), values.end());
    const double last = static_cast<double>(values.size() - 1);
    std::size_t low = static_cast<std::size_t>(kSure * last);
    std::size_t high = static_cast<std::size_t>((1.0 - kSure) * last);
    const double gap = kGap * static_cast<double>(values[high] - values[low]);
    while (low > 0 && static_cast<double>(values[low] - values[low - 1]) <= gap)
        --low;
    while (high + 1 < values.size() && static_cast<double>(values[high + 1] - values[high]) <= gap)
        ++high;
    return {static_cast<double>(values[low]), static_cast<double>(values[high])};
}

/// Where a place of the plan lies on the picture.
struct Map {
    Range x, y;  // m, shown
    double pixels_per_metre = 1, border = 0;

    int column(float at) const {
        return static_cast<int>(border + pixels_per_metre * (static_cast<double>(at) - x.low));
    }
    int row(float at) const {
        return static_cast<int>(border + pixels_per_metre * (y.high - static_cast<double>(at)));
    }
    int side(const Range& range) const {
        return static_cast<int>(std::lround(pixels_per_metre * range.length() + 2.0 * border));
    }
};

Map map_of(const Plan& plan, std::uint32_t pixels) {
    std::vector<float> xs, ys;
    for (const Placed& p : plan.placed) {
        const std::vector<Vec3f>& positions = p.scan->points.positions;
        const std::size_t step = std::max<std::size_t>(1, positions.size() / kLooked);
        for (std::size_t i = 0; i < positions.size(); i += step) {
            const Vec3f& q = positions[i];
            const Eigen::Vector3f w = p.T_plan_scan * Eigen::Vector3f(q.x, q.y, q.z);
            if (!w.allFinite()) continue;
            xs.push_back(w.x());
            ys.push_back(w.y());
        }
    }
    if (xs.empty()) {
        throw Error(ExitCode::kDegenerate, "no scan is placed, so there is no plan view to draw");
    }
    Map map{.x = shown_range(std::move(xs)), .y = shown_range(std::move(ys))};
    const double longest = std::max({map.x.length(), map.y.length(), 1e-6});
    map.border = kMargin * static_cast<double>(pixels);
    map.pixels_per_metre = (static_cast<double>(pixels) - 2.0 * map.border) / longest;
    return map;
}

/// Points as light, then the stations with their numbers over them.
void draw_scans(Canvas& canvas, const Plan& plan, const Map& map) {
    std::size_t drawn = 0;
    for (std::size_t s = 0; s < plan.placed.size(); ++s) {
        const std::array<float, 3> colour = scan_colour(s);
        for (const Vec3f& q : plan.placed[s].scan->points.positions) {
            const Eigen::Vector3f w = plan.placed[s].T_plan_scan * Eigen::Vector3f(q.x, q.y, q.z);
            if (!w.allFinite() || w.head<2>().cwiseAbs().maxCoeff() > 1e6f) continue;
            canvas.add(map.column(w.x()), map.row(w.y()), colour);
            ++drawn;
        }
    }
    const double density =
        static_cast<double>(drawn) / (static_cast<double>(canvas.width) * canvas.height);
    canvas.develop(static_cast<float>(0.5 / std::max(density, 0.05)));

    for (std::size_t s = 0; s < plan.placed.size(); ++s) {
        const Eigen::Vector3f& station = plan.placed[s].station;
        const int x = map.column(station.x()), y = map.row(station.y());
        canvas.disc(x, y, kStationRadius, kWhite);
        canvas.disc(x, y, kStationRadius - 2, as_code(scan_colour(s)));
        const std::string number = fmt::format("{}", s + 1);
        const int left = x + kStationRadius + 1, top = y - kStationRadius - 2;
        canvas.fill(left, top, written_width(number) + 4, text_height(kLetterScale) + 2, kPaper);
        canvas.write(number, left + 2, top + 2, kWhite);
    }
}

void draw_bar_of(Canvas& canvas, const Map& map) {
    const double longest =
        kLongestBar * map.pixels_per_metre * std::max(map.x.length(), map.y.length());
    draw_scale_bar(canvas, static_cast<int>(map.border), canvas.height - kLineHeight,
                   static_cast<int>(longest), map.pixels_per_metre, kPale);
}

/// The names beside the map: placed scans by number and colour, then those that are not placed.
void draw_legend(Canvas& canvas, const Plan& plan, int left) {
    const int rows = std::max(1, (canvas.height - kArrow - kFoot) / kLineHeight - 1);
    int line = 0;
    const auto place = [&] { return kLineHeight + kLineHeight * line++; };
    for (std::size_t s = 0; s < plan.placed.size() && line < rows; ++s) {
        const int y = place();
        canvas.disc(left + kStationRadius, y + kLineHeight / 4, kStationRadius,
                    as_code(scan_colour(s)));
        canvas.write(fmt::format("{} {}", s + 1, plan.placed[s].name), left + 3 * kStationRadius, y,
                     kPale);
    }
    for (std::size_t s = 0; s < plan.unplaced.size() && line < rows; ++s)
        canvas.write("not placed: " + plan.unplaced[s], left, place(), kRed);
    const std::size_t all = plan.placed.size() + plan.unplaced.size();
    const std::size_t named = static_cast<std::size_t>(line);
    if (all > named) canvas.write(fmt::format("and {} more", all - named), left, place(), kPale);
}

int legend_width(const Plan& plan) {
    int width = 0;
    for (const Placed& p : plan.placed)
        width = std::max(width, written_width("0000 " + p.name));
    for (const std::string& name : plan.unplaced)
        width = std::max(width, written_width("not placed: " + name));
    return width + 5 * kStationRadius;
}

}  // namespace

Picture draw_plan_view(std::span<const Scan> scans, const Poses& poses, std::uint32_t pixels) {
    if (pixels < 64 || pixels > 8192)
        throw Error(ExitCode::kUsage, "a plan view is 64 to 8192 pixels wide");
    const Plan plan = plan_of(scans, poses);
    const Map map = map_of(plan, pixels);
    const int map_width = map.side(map.x), legend = map_width + kStationRadius;
    Canvas canvas(map_width + legend_width(plan),
                  std::max(map.side(map.y), 6 * kLineHeight) + kFoot);

    draw_scans(canvas, plan, map);
    draw_bar_of(canvas, map);
    draw_legend(canvas, plan, legend);
    // Coordinates of a national grid have north along Y; others only say where Y is.
    draw_arrow(canvas, legend + kArrow, canvas.height - kLineHeight, kArrow,
               poses.origin != Vec3d{} ? "north" : "y axis", kPale);
    return std::move(static_cast<Picture&>(canvas));
}

void write_plan_view(std::span<const Scan> scans, const Poses& poses,
                     const std::filesystem::path& file, std::uint32_t pixels) {
    write_png(draw_plan_view(scans, poses, pixels), file);
}

}  // namespace glowworm
