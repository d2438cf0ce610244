#include "preprocess/write/las.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "octree/atomic_file.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::size_t kHeaderBytes = 375, kRecordHeadBytes = 54, kExtraBytes = 192;
constexpr std::size_t kBlockPoints = 65536;
constexpr double kSmallestStep = 1e-5;  // m

struct Layout {
    bool coloured, timed, normals;
    std::size_t record_bytes = 0, colour = 30, normal = 0;

    explicit Layout(const Points& points)
        : coloured(!points.colours.empty()),
          timed(!points.times.empty()),
          normals(!points.normals.empty()),
          normal(coloured ? 36 : 30) {
        record_bytes = normal + (normals ? 12 : 0);
    }
};

struct Bounds {
    Vec3f least, most;  ///< m, relative to the origin; zero without points
};

Bounds bounds_of(const Points& points) {
    if (points.empty()) return {};
    Bounds bounds{points.positions[0], points.positions[0]};
    for (const Vec3f& position : points.positions) {
        bounds.least = component_min(bounds.least, position);
        bounds.most = component_max(bounds.most, position);
    }
    return bounds;
}

double choose_step(const Bounds& bounds) {
    double reach = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
        reach = std::max({reach, std::abs(static_cast<double>(bounds.least[axis])),
                          std::abs(static_cast<double>(bounds.most[axis]))});
    }
    double step = kSmallestStep;
    while (reach > step * std::numeric_limits<std::int32_t>::max())
        step *= 10.0;
    return step;
}

std::int32_t stored(float coordinate, double step) {
    return static_cast<std::int32_t>(std::lround(static_cast<double>(coordinate) / step));
}

/// Intensities as 16 bits: 0..1 fills them, counts that fit stay, all else is spread between its
/// least and its most.
struct IntensityScale {
    double factor = 1.0, least = 0.0;

    explicit IntensityScale(const std::vector<float>& intensities) {
        if (intensities.empty()) return;
        const auto [low, high] = std::minmax_element(intensities.begin(), intensities.end());
        const double most = static_cast<double>(*high);
        least = static_cast<double>(*low);
        if (least >= 0.0 && most <= 1.0) {
            least = 0.0;
            factor = 65535.0;
        } else if (least >= 0.0 && most <= 65535.0) {
            least = 0.0;
        } else {
            factor = most > least ? 65535.0 / (most - least) : 0.0;
        }
    }
    std::uint16_t operator()(float intensity) const {
        const double value = (static_cast<double>(intensity) - least) * factor;
        return static_cast<std::uint16_t>(value > 0.0 ? std::min(value, 65535.0) + 0.5 : 0.0);
    }
};

void put_text(std::byte* at, std::string_view text) {
    std::transform(text.begin(), text.end(), at, [](char c) { return static_cast<std::byte>(c); });
}

std::vector<std::byte> make_header(const PointCloud& cloud, const Layout& layout, double step,
                                   const Bounds& bounds) {
    const std::size_t records = layout.normals ? kRecordHeadBytes + 3 * kExtraBytes : 0;
    std::vector<std::byte> header(kHeaderBytes + records);
    std::byte* at = header.data();
    put_text(at, "LASF");
    // Format 6 and later describe their reference system as WKT, even where they have none.
    store(at + 6, std::uint16_t{1 << 4});
    at[24] = std::byte{1};
    at[25] = std::byte{4};
    put_text(at + 26, "OTHER");
    put_text(at + 58, "Glowworm " GLOWWORM_VERSION);
    store(at + 94, static_cast<std::uint16_t>(kHeaderBytes));
    store(at + 96, static_cast<std::uint32_t>(header.size()));
    store(at + 100, std::uint32_t{layout.normals ? 1u : 0u});
    at[104] = layout.coloured ? std::byte{7} : std::byte{6};
    store(at + 105, static_cast<std::uint16_t>(layout.record_bytes));
    for (int axis = 0; axis < 3; ++axis) {
        const double origin = cloud.origin[axis];
        store(at + 131 + 8 * axis, step);
        store(at + 155 + 8 * axis, origin);
        store(at + 179 + 16 * axis, stored(bounds.most[axis], step) * step + origin);
        store(at + 187 + 16 * axis, stored(bounds.least[axis], step) * step + origin);
    }
    store(at + 247, std::uint64_t{cloud.points.size()});
    store(at + 255, std::uint64_t{cloud.points.size()});  // all of them first returns

    if (layout.normals) {
        std::byte* record = at + kHeaderBytes;
        put_text(record + 2, "LASF_Spec");
        store(record + 18, std::uint16_t{4});
        store(record + 20, static_cast<std::uint16_t>(3 * kExtraBytes));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::byte* entry = record + kRecordHeadBytes + axis * kExtraBytes;
            entry[2] = std::byte{9};  // float
            put_text(entry + 4, std::array{"NormalX", "NormalY", "NormalZ"}[axis]);
        }
    }
    return header;
}

}  // namespace

void write_las(const PointCloud& cloud, const std::filesystem::path& path) {
    const Points& points = cloud.points;
    const Layout layout(points);
    const Bounds bounds = bounds_of(points);
    const double step = choose_step(bounds);
    const IntensityScale intensity(points.intensities);

    AtomicFile file(path);
    const std::vector<std::byte> header = make_header(cloud, layout, step, bounds);
    file.write(header.data(), header.size());
    std::vector<std::byte> records;
    for (std::size_t begin = 0; begin < points.size(); begin += kBlockPoints) {
        const std::size_t end = std::min(begin + kBlockPoints, points.size());
        records.assign((end - begin) * layout.record_bytes, std::byte{0});
        for (std::size_t i = begin; i < end; ++i) {
            std::byte* at = records.data() + (i - begin) * layout.record_bytes;
            for (int axis = 0; axis < 3; ++axis) {
                store(at + 4 * axis, stored(points.positions[i][axis], step));
            }
            if (!points.intensities.empty()) store(at + 12, intensity(points.intensities[i]));
            at[14] = std::byte{0x11};  // first return of one
            if (!points.stations.empty() && points.stations[i] < 65535) {
                store(at + 20, static_cast<std::uint16_t>(points.stations[i] + 1));
            }
            if (layout.timed) store(at + 22, points.times[i]);
            if (layout.coloured) {
                const Rgb8& colour = points.colours[i];
                // 255 becomes 65535.
                store(at + layout.colour, static_cast<std::uint16_t>(colour.r * 257));
                store(at + layout.colour + 2, static_cast<std::uint16_t>(colour.g * 257));
                store(at + layout.colour + 4, static_cast<std::uint16_t>(colour.b * 257));
            }
            if (layout.normals) store(at + layout.normal, points.normals[i]);
        }
        file.write(records.data(), records.size());
    }
    file.commit();
}

}  // namespace glowworm
