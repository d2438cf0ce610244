#include "preprocess/register/plan_view.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "octree/atomic_file.h"
#include "octree/error.h"
#include "preprocess/register/lettering.h"

namespace glowworm {
namespace {

constexpr std::uint8_t kPaper = 16;  // of 255: scans glow on a dark ground
constexpr double kMargin = 0.04;     // of the longer side
constexpr int kStationRadius = 6;    // pixels
constexpr int kLetters = 2;          // pixels per dot of the letters
constexpr int kLine = 24;            // pixels between lines of the legend
constexpr std::uint8_t kPale = 200;  // of 255: words and marks
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

class Canvas {
  public:
    Canvas(std::uint32_t columns, std::uint32_t rows)
        : width(columns),
          height(rows),
          rgb(std::size_t{3} * columns * rows, kPaper),
          light_(rgb.size(), 0.0f) {}

    void add(int x, int y, const std::array<float, 3>& colour) {
        if (!inside(x, y)) return;
        for (std::size_t k = 0; k < 3; ++k)
            light_[at(x, y) + k] += colour[k];
    }
    void set(int x, int y, std::uint8_t r, std::uint8_t g, std::uint8_t b) {
        if (!inside(x, y)) return;
        rgb[at(x, y)] = r, rgb[at(x, y) + 1] = g, rgb[at(x, y) + 2] = b;
    }
    void write(const std::string& text, int x, int y, std::uint8_t r, std::uint8_t g,
               std::uint8_t b) {
        draw_text(text, x, y, kLetters, [&](int u, int v) { set(u, v, r, g, b); });
    }
    void disc(int cx, int cy, const std::array<float, 3>& colour) {
        for (int dy = -kStationRadius; dy <= kStationRadius; ++dy) {
            for (int dx = -kStationRadius; dx <= kStationRadius; ++dx) {
                const int d2 = dx * dx + dy * dy;
                if (d2 > kStationRadius * kStationRadius) continue;
                const bool ring = d2 > (kStationRadius - 2) * (kStationRadius - 2);
                const auto code = [&](std::size_t k) {
                    return ring ? std::uint8_t{255} : static_cast<std::uint8_t>(255.0f * colour[k]);
                };
                set(cx + dx, cy + dy, code(0), code(1), code(2));
            }
        }
    }
    /// Points over one another add up to 1 - exp(-light).
    void develop(float exposure) {
        for (std::size_t i = 0; i < rgb.size(); ++i) {
            const float v = 1.0f - std::exp(-exposure * light_[i]);
            rgb[i] = static_cast<std::uint8_t>(kPaper + std::lround((255.0f - kPaper) * v));
        }
    }

    std::uint32_t width, height;
    std::vector<std::uint8_t> rgb;

  private:
    bool inside(int x, int y) const {
        return x >= 0 && y >= 0 && x < static_cast<int>(width) && y < static_cast<int>(height);
    }
    std::size_t at(int x, int y) const {
        return (static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)) * 3;
    }
    std::vector<float> light_;
};

void write_png(const Canvas& canvas, const std::filesystem::path& file) {
    AtomicFile out(file);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = canvas.width;
    image.height = canvas.height;
    image.format = PNG_FORMAT_RGB;
    png_alloc_size_t bytes = 0;
    std::vector<std::uint8_t> encoded;
    bool good =
        png_image_write_to_memory(&image, nullptr, &bytes, 0, canvas.rgb.data(), 0, nullptr) != 0;
    encoded.resize(bytes);
    good = good && png_image_write_to_memory(&image, encoded.data(), &bytes, 0, canvas.rgb.data(),
                                             0, nullptr) != 0;
    if (!good)
        throw Error(ExitCode::kInternal, file.string() + ": the plan view cannot be encoded");
    out.write(encoded.data(), bytes);
    out.commit();
}

/// The round length (1, 2 or 5 times a power of ten) next below `length`.
double round_length(double length) {
    const double power = std::pow(10.0, std::floor(std::log10(length)));
    for (const double step : {5.0, 2.0}) {
        if (step * power <= length) return step * power;
    }
    return power;
}

std::string short_name(const std::string& file) {
    std::string name = std::filesystem::path(file).filename().string();
    if (name.size() > kLongestName) name = "..." + name.substr(name.size() - kLongestName + 3);
    return name;
}

/// The names beside the map: placed scans by number and colour, then those that are not placed.
void draw_legend(Canvas& canvas, std::span<const Placed> placed,
                 std::span<const std::string> unplaced, int left) {
    const int rows = std::max(1, static_cast<int>(canvas.height) / kLine - 3);
    int line = 0;
    const auto place = [&] { return kLine + kLine * line++; };
    for (std::size_t s = 0; s < placed.size() && line < rows; ++s) {
        const int y = place();
        canvas.disc(left + kStationRadius, y + kLine / 4, scan_colour(s));
        canvas.write(fmt::format("{} {}", s + 1, placed[s].name), left + 3 * kStationRadius, y,
                     kPale, kPale, kPale);
    }
    for (std::size_t s = 0; s < unplaced.size() && line < rows; ++s)
        canvas.write(fmt::format("not placed: {}", unplaced[s]), left, place(), 255, 96, 96);
    const std::size_t all = placed.size() + unplaced.size();
    if (all > static_cast<std::size_t>(line)) {
        canvas.write(fmt::format("and {} more", all - static_cast<std::size_t>(line)), left,
                     place(), kPale, kPale, kPale);
    }
}

/// An arrow of `length` pixels up from (x, y), the word at its tip.
void draw_arrow(Canvas& canvas, int x, int y, int length, const std::string& word) {
    for (int v = 0; v < length; ++v) {
        const int half = std::max(1, std::min(8, v / 2) * (v < 16 ? 1 : 0));
        for (int u = -half; u <= half; ++u)
            canvas.set(x + u, y - length + v, kPale, kPale, kPale);
    }
    canvas.write(word, x - text_width(word, kLetters) / 2, y - length - text_height(kLetters) - 2,
                 kPale, kPale, kPale);
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
        return static_cast<std::uint32_t>(std::lround(scale * length + 2.0 * border));
    };
    // The legend stands right of the map, which is at least high enough for a few lines.
    std::uint32_t words = 0;
    const auto widen = [&](const std::string& text) {
        words = std::max(words, static_cast<std::uint32_t>(text_width(text, kLetters)));
    };
    for (const Placed& p : placed)
        widen("0000 " + p.name);
    for (const std::string& name : unplaced)
        widen("not placed: " + name);
    const std::uint32_t map_width = side(right - left);
    Canvas canvas(map_width + words + 4 * kStationRadius,
                  std::max<std::uint32_t>(side(high - low), 8 * kLine));
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
        for (int v = -kStationRadius - 2; v < text_height(kLetters) - kStationRadius; ++v) {
            for (int u = 0; u < text_width(number, kLetters) + 4; ++u)
                canvas.set(x + kStationRadius + 1 + u, y + v, kPaper, kPaper, kPaper);
        }
        canvas.write(number, x + kStationRadius + 3, y - kStationRadius, 255, 255, 255);
    }
    const double length = round_length(0.3 * longest);
    const int bar = static_cast<int>(scale * length), bottom = static_cast<int>(canvas.height) - 12;
    const int start = static_cast<int>(border);
    for (int x = 0; x < bar; ++x) {
        for (int y = 0; y < 3; ++y)
            canvas.set(start + x, bottom + y, kPale, kPale, kPale);
    }
    canvas.write(fmt::format("{:g} m", length), start, bottom - text_height(kLetters) - 2, kPale,
                 kPale, kPale);
    const int legend = static_cast<int>(map_width) + kStationRadius;
    draw_legend(canvas, placed, unplaced, legend);
    // Coordinates of a national grid have north along Y; others only say where Y is.
    const bool georeferenced = poses.origin != Vec3d{};
    draw_arrow(canvas, legend + 2 * kStationRadius, bottom, 48, georeferenced ? "N" : "Y");
    write_png(canvas, file);
}

}  // namespace glowworm
