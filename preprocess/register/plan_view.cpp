#include "preprocess/register/plan_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "octree/error.h"
#include "preprocess/plot/lettering.h"
#include "preprocess/plot/map_marks.h"

namespace glowworm {
namespace {

constexpr Rgb8 kPaper{16, 16, 16};    // scans glow on a dark ground
constexpr double kMargin = 0.04;      // of the longer side
constexpr int kStationRadius = 6;     // pixels
constexpr Rgb8 kPale{200, 200, 200};  // words and marks
constexpr Rgb8 kRed{255, 96, 96};
constexpr Rgb8 kWhite{255, 255, 255};
constexpr std::size_t kLongestName = 32;

struct Placed {
    const Scan* scan;
    std::string name;
    Eigen::Isometry3f T_plan_scan;  ///< of the scan's positions
    Eigen::Vector3f station;
};

/// Colours far apart from one another: hues at the golden angle.
std::array<float, 3> scan_colour(std::size_t index) {
    const double hue = std::fmod(0.61803398875 * static_cast<double>(index), 1.0) * 6.0;
    std::array<float, 3> colour;
    for (std::size_t k = 0; k < 3; ++k) {
        const double phase = std::fmod(hue + (k == 0 ? 0.0 : k == 1 ? 4.0 : 2.0), 6.0);
        colour[k] =
            static_cast<float>(0.35 + 0.65 * std::clamp(std::abs(phase - 3.0) - 1.0, 0.0, 1.0));
    }
    return colour;
}

/// A picture on which points add up to light until it is developed.
struct Canvas : Picture {
    Canvas(int columns, int rows) : Picture(columns, rows, kPaper), light(pixels.size()) {}

    void add(int x, int y, const std::array<float, 3>& colour) {
        if (!holds(x, y)) return;
        std::array<float, 3>& sum =
            light[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
        for (std::size_t k = 0; k < 3; ++k)
            sum[k] += colour[k];
    }

    void disc(int cx, int cy, const std::array<float, 3>& colour) {
        const auto code = [&](std::size_t k) {
            return static_cast<std::uint8_t>(255.0f * colour[k]);
        };
        for (int dy = -kStationRadius; dy <= kStationRadius; ++dy) {
            for (int dx = -kStationRadius; dx <= kStationRadius; ++dx) {
                const int d2 = dx * dx + dy * dy;
                if (d2 > kStationRadius * kStationRadius) continue;
                const bool ring = d2 > (kStationRadius - 2) * (kStationRadius - 2);
                set(cx + dx, cy + dy, ring ? kWhite : Rgb8{code(0), code(1), code(2)});
            }
        }
    }

    /// Points over one another add up to 1 - exp(-light).
    void develop(float exposure) {
        const auto code = [&](float sum) {
            const float v = 1.0f - std::exp(-exposure * sum);
            return static_cast<std::uint8_t>(kPaper.r + std::lround((255.0f - kPaper.r) * v));
        };
        for (std::size_t i = 0; i < pixels.size(); ++i)
            pixels[i] = {code(light[i][0]), code(light[i][1]), code(light[i][2])};
    }

    std::vector<std::array<float, 3>> light;
};

std::string short_name(const std::string& file) {
    std::string name = std::filesystem::path(file).filename().string();
    if (name.size() > kLongestName) name = "..." + name.substr(name.size() - kLongestName + 3);
    return name;
}

/// The names beside the map: placed scans by number and colour, then those that are not placed.
void draw_legend(Canvas& canvas, std::span<const Placed> placed,
                 std::span<const std::string> unplaced, int left) {
    const int rows = std::max(1, canvas.height / kLineHeight - 3);
    int line = 0;
    const auto place = [&] { return kLineHeight + kLineHeight * line++; };
    for (std::size_t s = 0; s < placed.size() && line < rows; ++s) {
        const int y = place();
        canvas.disc(left + kStationRadius, y + kLineHeight / 4, scan_colour(s));
        canvas.write(fmt::format("{} {}", s + 1, placed[s].name), left + 3 * kStationRadius, y,
                     kPale);
    }
    for (std::size_t s = 0; s < unplaced.size() && line < rows; ++s)
        canvas.write(fmt::format("not placed: {}", unplaced[s]), left, place(), kRed);
    const std::size_t all = placed.size() + unplaced.size();
    if (all > static_cast<std::size_t>(line)) {
        canvas.write(fmt::format("and {} more", all - static_cast<std::size_t>(line)), left,
                     place(), kPale);
    }
}

}  // namespace

void write_plan_view(std::span<const Scan> scans, const Poses& poses,
                     const std::filesystem::path& file, std::uint32_t pixels) {
    if (pixels < 64 || pixels > 8192) {
        throw Error(ExitCode::kUsage, "a plan view is 64 to 8192 pixels wide");
    }
    // 1. Placed scans, relative to the first station so that floats hold them.
    std::vector<Placed> placed;
    std::vector<std::string> unplaced;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const Scan& scan : scans) {
        const ScanPose* pose = find_pose(poses, scan);
        if (pose == nullptr || pose->status == PoseStatus::kUnregistered) {
            unplaced.push_back(short_name(pose_file(scan)));
            continue;
        }
        const Eigen::Isometry3d T =
            pose->T_world_scan * Eigen::Translation3d(scan.offset.x, scan.offset.y, scan.offset.z);
        if (placed.empty()) middle = T.translation();
        placed.push_back({&scan, short_name(pose_file(scan)),
                          (Eigen::Translation3d(-middle) * T).cast<float>(),
                          (pose->T_world_scan.translation() - middle).cast<float>()});
    }
    // 2. What to show: all but the farthest hundredth of the points.
    std::vector<float> xs, ys;
    for (const Placed& p : placed) {
        const std::vector<Vec3f>& positions = p.scan->points.positions;
        const std::size_t step = std::max<std::size_t>(1, positions.size() / 20000);
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
    std::sort(xs.begin(), xs.end());
    std::sort(ys.begin(), ys.end());
    const auto at = [](const std::vector<float>& v, double share) {
        return static_cast<double>(
            v[static_cast<std::size_t>(share * static_cast<double>(v.size() - 1))]);
    };
    const double left = at(xs, 0.005), right = at(xs, 0.995), low = at(ys, 0.005),
                 high = at(ys, 0.995);
    const double longest = std::max({right - left, high - low, 1e-6});
    const double scale = static_cast<double>(pixels) * (1.0 - 2.0 * kMargin) / longest;
    const double border = kMargin * static_cast<double>(pixels);
    const auto side = [&](double length) {
        return static_cast<int>(std::lround(scale * length + 2.0 * border));
    };
    // The legend stands right of the map, which is at least high enough for a few lines.
    int words = 0;
    const auto widen = [&](const std::string& text) {
        words = std::max(words, written_width(text));
    };
    for (const Placed& p : placed)
        widen("0000 " + p.name);
    for (const std::string& name : unplaced)
        widen("not placed: " + name);
    const int map_width = side(right - left);
    Canvas canvas(map_width + words + 4 * kStationRadius,
                  std::max(side(high - low), 8 * kLineHeight));
    const auto column = [&](float x) {
        return static_cast<int>(border + scale * (static_cast<double>(x) - left));
    };
    const auto row = [&](float y) {
        return static_cast<int>(border + scale * (high - static_cast<double>(y)));
    };

    // 3. Points as light, then stations and a scale bar over them.
    std::size_t drawn = 0;
    for (std::size_t s = 0; s < placed.size(); ++s) {
        const std::array<float, 3> colour = scan_colour(s);
        for (const Vec3f& q : placed[s].scan->points.positions) {
            const Eigen::Vector3f w = placed[s].T_plan_scan * Eigen::Vector3f(q.x, q.y, q.z);
            if (!w.allFinite() || w.head<2>().cwiseAbs().maxCoeff() > 1e6f) continue;
            canvas.add(column(w.x()), row(w.y()), colour);
            ++drawn;
        }
    }
    const double density =
        static_cast<double>(drawn) / (static_cast<double>(canvas.width) * canvas.height);
    canvas.develop(static_cast<float>(0.35 / std::max(density, 0.05)));
    for (std::size_t s = 0; s < placed.size(); ++s) {
        const int x = column(placed[s].station.x()), y = row(placed[s].station.y());
        canvas.disc(x, y, scan_colour(s));
        const std::string number = fmt::format("{}", s + 1);
        canvas.fill(x + kStationRadius + 1, y - kStationRadius - 2, written_width(number) + 4,
                    text_height(kLetterScale) + 2, kPaper);
        canvas.write(number, x + kStationRadius + 3, y - kStationRadius, kWhite);
    }
    const int bottom = canvas.height - 12;
    draw_scale_bar(canvas, static_cast<int>(border), bottom,
                   static_cast<int>(0.3 * scale * longest), scale, kPale);
    const int legend = map_width + kStationRadius;
    draw_legend(canvas, placed, unplaced, legend);
    // Coordinates of a national grid have north along Y; others only say where Y is.
    const bool georeferenced = poses.origin != Vec3d{};
    draw_arrow(canvas, legend + 2 * kStationRadius, bottom, 48, georeferenced ? "N" : "Y", kPale);
    write_png(canvas, file);
}

}  // namespace glowworm
