// How fast, how big and how true `glowworm surface` is, beside PCL's and CGAL's normal estimation
// on the same points. The peers find neighbours and normals; ours is the whole stage: neighbours,
// normals, orientation, NDF lengths, radii and albedo.
//
//   surface_table [millions of points = 1.4[,more...]] [k = 16] [all | ours | growing]
//
// Build it in the release preset and let nothing else run.

#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/info.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "cgal_normals.h"
#include "preprocess/surface/flann_neighbours.h"
#include "preprocess/surface/neighbours.h"
#include "preprocess/surface/surface.h"
#include "surface/accuracy.h"
#include "surface/pcl_normals.h"
#include "surface/shapes.h"

namespace glowworm::bench {
namespace {

/// A winding passage of 3 m bore with bumps, a point every 20 mm, 3 mm of noise and a station every
/// 8 m: longer for more points, so that the density stays.
testing::Shape make_passage(std::size_t n) {
    constexpr double kRadius = 1.5, kSpacing = 0.02;
    const double length =
        static_cast<double>(n) * kSpacing * kSpacing / (2 * std::numbers::pi * kRadius);
    const auto centre = [](double s) {
        return Vec3d{s, 3.0 * std::sin(s / 7.0), std::sin(s / 5.0)};
    };
    const auto surface = [&](double s, double phi) {
        const double r = kRadius * (1.0 + 0.08 * std::sin(3.0 * phi + s) * std::sin(2.0 * s));
        return centre(s) + Vec3d{0.0, r * std::cos(phi), r * std::sin(phi)};
    };
    testing::Shape shape;
    testing::Random random;
    for (double s = 4.0; s < length + 4.0; s += 8.0) {
        shape.cloud.stations.push_back(testing::station_at(centre(s)));
    }
    for (std::size_t i = 0; i < n; ++i) {
        const double s = random.uniform(0.0, length);
        const double phi = random.uniform(0.0, 2.0 * std::numbers::pi);
        const Vec3d along = surface(s + 1e-4, phi) - surface(s - 1e-4, phi);
        const Vec3d around = surface(s, phi + 1e-4) - surface(s, phi - 1e-4);
        Vec3d normal = normalized(cross(along, around));
        if (dot(normal, centre(s) - surface(s, phi)) < 0.0) normal = -normal;
        const auto station =
            std::min(static_cast<std::size_t>(s / 8.0), shape.cloud.stations.size() - 1);
        testing::add_point(shape, surface(s, phi), normal, static_cast<std::uint32_t>(station));
    }
    testing::add_noise(shape, 0.003);
    return shape;
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/// Most memory held since the last reset, bytes; resets it.
std::size_t peak_bytes() {
    std::ifstream status("/proc/self/status");
    std::size_t kib = 0;
    for (std::string line; std::getline(status, line);) {
        if (line.rfind("VmHWM:", 0) == 0) kib = std::strtoull(line.c_str() + 6, nullptr, 10);
    }
    std::ofstream("/proc/self/clear_refs") << 5;
    return kib * 1024;
}

void row(const std::string& name, std::size_t n, const std::function<void()>& work) {
    peak_bytes();
    const std::size_t before = peak_bytes();
    const double wall = wall_seconds(), cpu = cpu_seconds();
    work();
    const double seconds = wall_seconds() - wall, busy = cpu_seconds() - cpu;
    const double points = static_cast<double>(n);
    fmt::print(
        "{:24} {:8.2f} s wall {:8.2f} s cpu {:8.3f} M points/s {:8.3f} M points/cpu s {:6.0f} "
        "B/point more\n",
        name, seconds, busy, points / seconds * 1e-6, points / busy * 1e-6,
        static_cast<double>(peak_bytes() - before) / points);
}

double median_angle(std::span<const Vec3f> normals, std::span<const Vec3f> truth, double share) {
    std::vector<double> angles;
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const double c = std::abs(dot(vec3_cast<double>(normals[i]), vec3_cast<double>(truth[i])));
        angles.push_back(std::acos(std::min(c, 1.0)) * 180.0 / std::numbers::pi);
    }
    const auto rank =
        angles.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(angles.size()));
    std::nth_element(angles.begin(), rank, angles.end());
    return *rank;
}

void print_angles(std::span<const Vec3f> normals, const testing::Shape& shape) {
    fmt::print("{:24} median {:.3f} deg, 95 % {:.3f} deg\n", "",
               median_angle(normals, shape.normals, 0.5),
               median_angle(normals, shape.normals, 0.95));
}

enum class What { kAll, kOurs, kGrowing };

void run(std::size_t n, int k, What what) {
    const testing::Shape shape = make_passage(n);
    const std::vector<Vec3f>& positions = shape.cloud.points.positions;
    const int threads = tbb::info::default_concurrency();
    fmt::print("{} points, k = {}, {} threads\n", n, k, threads);

    for (const bool grow : {false, true}) {
        if (!grow && what == What::kGrowing) continue;
        SurfaceSettings settings;
        settings.k = k;
        if (!grow) settings.max_k = k;
        SurfaceReport report;
        SurfelCloud cloud;
        row(grow ? "glowworm, growing" : "glowworm", n,
            [&] { cloud = make_surfels(shape.cloud, settings, &report); });
        std::vector<Vec3f> normals;
        for (const Surfel& surfel : cloud.surfels)
            normals.push_back(surfel.normal);
        if (normals.size() == n) print_angles(normals, shape);
    }
    if (what != What::kAll) return;

    PointTree tree;
    row("tree", n, [&] { tree = make_point_tree(positions); });
    row("neighbours", n, [&] { nearest_neighbours(tree, k - 1, 1.0f); });
    row("neighbours, FLANN", n, [&] { flann_neighbours(tree, k - 1, 1.0f); });
    std::vector<Vec3f> normals;
    row("PCL NormalEstimationOMP", n,
        [&] { normals = testing::pcl_normals(positions, k, threads); });
    print_angles(normals, shape);
    row("CGAL pca_estimate_normals", n, [&] { normals = cgal_normals(positions, k); });
    print_angles(normals, shape);
}

}  // namespace
}  // namespace glowworm::bench

int main(int argc, char** argv) {
    using glowworm::bench::What;
    std::istringstream millions(argc > 1 ? argv[1] : "1.4");
    const int k = argc > 2 ? std::atoi(argv[2]) : 16;
    const std::string word = argc > 3 ? argv[3] : "all";
    const What what = word == "ours"      ? What::kOurs
                      : word == "growing" ? What::kGrowing
                                          : What::kAll;
    for (std::string size; std::getline(millions, size, ',');) {
        glowworm::bench::run(static_cast<std::size_t>(std::atof(size.c_str()) * 1e6), k, what);
    }
}
