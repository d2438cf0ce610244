// Points per second from a binary PLY on disk to a closed, checksummed .svo, beside the physical
// limit in the same run: read the file, radix-sort 64-bit keys with their payload, write the result
// once. Usage: build_octree [millions of points] [repeats] [folder] [memory limit in MB]
// With a limit: only the build from a stream within that limit, its time and peak memory.

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bench/ply_points.h"
#include "octree/atomic_file.h"
#include "octree/build.h"
#include "octree/build_file.h"
#include "octree/check.h"
#include "octree/radix_sort.h"
#include "octree/statistics.h"
#include "preprocess/surface/surfel_file.h"

namespace {

using namespace glowworm;
namespace fs = std::filesystem;

/// A bumpy chamber of 8 m, points in the order of a scanner's sweeps.
void write_cave(const fs::path& path, std::size_t count) {
    std::ofstream stream(path, std::ios::binary);
    write_ply_header(stream, count);
    std::mt19937 random(1);
    std::normal_distribution<float> noise(0.0f, 0.003f);
    std::vector<PlyPoint> batch;
    const double golden = std::numbers::pi * (3.0 - std::sqrt(5.0));
    for (std::size_t i = 0; i < count; ++i) {
        // Four stations sweep the same surface one after the other.
        const double t =
            static_cast<double>(i % (count / 4 + 1)) / static_cast<double>(count / 4 + 1);
        const double z = 1.0 - 2.0 * t, angle = golden * static_cast<double>(i);
        const double flat = std::sqrt(std::max(0.0, 1.0 - z * z));
        const Vec3d d{flat * std::cos(angle), flat * std::sin(angle), z};
        const double r =
            4.0 + 0.3 * std::sin(9.0 * d.x) * std::sin(7.0 * d.y) * std::cos(8.0 * d.z);
        const Vec3f p = vec3_cast<float>(d * r);
        const float radius = static_cast<float>(8.0 / std::sqrt(static_cast<double>(count)));
        batch.push_back(
            {{p.x + noise(random), p.y + noise(random), p.z + noise(random)},
             {static_cast<float>(-d.x), static_cast<float>(-d.y), static_cast<float>(-d.z)},
             {120, 100, 80},
             radius});
        if (batch.size() == 65536 || i + 1 == count) {
            write_ply_points(stream, batch);
            batch.clear();
        }
    }
}

std::vector<char> read_file(const fs::path& path) {
    std::vector<char> bytes(fs::file_size(path));
    const int file = ::open(path.c_str(), O_RDONLY);
    std::size_t done = 0;
    while (done < bytes.size()) {
        const ssize_t got = ::read(file, bytes.data() + done, bytes.size() - done);
        if (got <= 0) std::abort();
        done += static_cast<std::size_t>(got);
    }
    ::close(file);
    return bytes;
}

std::size_t header_size(const std::vector<char>& bytes) {
    constexpr std::string_view kEnd = "end_header\n";
    return std::string_view(bytes.data(), 1000).find(kEnd) + kEnd.size();
}

double seconds(const auto& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double cpu_seconds() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    const auto seconds_of = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
}

/// The least that any such program must do.
void touch_the_limit(const fs::path& input, const fs::path& output) {
    const std::vector<char> bytes = read_file(input);
    const std::size_t start = header_size(bytes);
    const std::size_t count = (bytes.size() - start) / sizeof(PlyPoint);
    CodeIndices entries(count);
    Grid grid;
    grid.cube_min = {-5, -5, -5};
    grid.cube_edge = 10;
    for (std::size_t i = 0; i < count; ++i) {
        float p[3];
        std::memcpy(p, bytes.data() + start + i * sizeof(PlyPoint), sizeof p);
        entries[i] = {grid.code_of({p[0], p[1], p[2]}), static_cast<std::uint32_t>(i), 0};
    }
    radix_sort(entries);
    std::vector<char> sorted(count * sizeof(PlyPoint));
    for (std::size_t i = 0; i < count; ++i) {
        std::memcpy(sorted.data() + i * sizeof(PlyPoint),
                    bytes.data() + start + entries[i].index * sizeof(PlyPoint), sizeof(PlyPoint));
    }
    AtomicFile file(output);
    file.write(sorted.data(), sorted.size());
    file.commit();
}

long peak_megabytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024;
}

/// When each stage of a build ended, s from its beginning: the build reports what it has done after
/// reading, sorting, splatting and packing.
struct StageClock {
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
    std::map<std::uint64_t, double> at;  ///< by fifths done

    void reached(std::uint64_t done, std::uint64_t total) {
        at[total > 0 ? done * 5 / total : 0] =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
};

void build_whole(const fs::path& ply, const fs::path& svo, StageClock& clock) {
    const SurfelFile file = open_surfels(ply, {}, 0.5f);
    build_octree_file(file.stream, {}, {}, svo,
                      [&](std::uint64_t done, std::uint64_t total) { clock.reached(done, total); });
}

void build_within(std::uint64_t megabytes, double millions, const fs::path& ply,
                  const fs::path& svo) {
    BuildFileReport report;
    const double took = seconds([&] {
        const SurfelFile file = open_surfels(ply, {}, 0.5f);
        report = build_octree_file(file.stream, {}, {.limit = megabytes * 1000000}, svo);
    });
    std::printf(
        "%.1f M points within %llu MB: %.1f s, %.2f M points/s, %u tiles, %.0f MB spilled, peak "
        "%ld MB, file %.0f MB\n",
        millions, static_cast<unsigned long long>(megabytes), took, millions / took, report.tiles,
        static_cast<double>(report.spilled_bytes) * 1e-6, peak_megabytes(),
        static_cast<double>(fs::file_size(svo)) * 1e-6);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
    const double millions = argc > 1 ? std::atof(argv[1]) : 1.4;
    const int repeats = argc > 2 ? std::atoi(argv[2]) : 3;
    const fs::path folder = argc > 3 ? fs::path(argv[3]) : fs::temp_directory_path();
    const auto count = static_cast<std::size_t>(millions * 1e6);
    const fs::path ply = folder / "bench_cave.ply", svo = folder / "bench_cave.svo";
    write_cave(ply, count);
    if (argc > 4) {
        build_within(static_cast<std::uint64_t>(std::atoll(argv[4])), millions, ply, svo);
        fs::remove(ply);
        fs::remove(svo);
        return 0;
    }

    std::vector<double> limit, reading, sorting, leaves, packing, writing, whole;
    std::vector<double> limit_cpu, whole_cpu;
    for (int i = 0; i < repeats; ++i) {
        double cpu = cpu_seconds();
        limit.push_back(seconds([&] { touch_the_limit(ply, svo); }));
        limit_cpu.push_back(cpu_seconds() - cpu);
        cpu = cpu_seconds();
        StageClock clock;
        whole.push_back(seconds([&] { build_whole(ply, svo, clock); }));
        reading.push_back(clock.at[0]);
        sorting.push_back(clock.at[1] - clock.at[0]);
        leaves.push_back(clock.at[3] - clock.at[1]);
        packing.push_back(clock.at[5] - clock.at[3]);
        writing.push_back(whole.back() - clock.at[5]);
        whole_cpu.push_back(cpu_seconds() - cpu);
    }
    const double points = static_cast<double>(count);
    std::printf("%.1f M points, medians of %d\n", millions, repeats);
    std::printf("  limit (read, sort, write)  %6.2f s  %5.1f M points/s\n", median(limit),
                points / median(limit) * 1e-6);
    std::printf(
        "  read %.2f s, sort %.2f s, leaves %.2f s, nodes and points %.2f s, write %.2f s\n",
        median(reading), median(sorting), median(leaves), median(packing), median(writing));
    std::printf("  whole                      %6.2f s  %5.1f M points/s, %.2f of the limit\n",
                median(whole), points / median(whole) * 1e-6, median(whole) / median(limit));

    std::printf("  CPU seconds: limit %.2f, whole %.2f\n", median(limit_cpu), median(whole_cpu));

    std::vector<double> opening, info;
    OctreeStatistics statistics;
    for (int i = 0; i < 5; ++i) {
        opening.push_back(seconds([&] { OctreeFile::open(svo); }));
        info.push_back(seconds([&] {
            const OctreeFile file = OctreeFile::open(svo);
            statistics = measure_octree(file.view(), file.bytes());
        }));
    }
    std::printf("  open %.3f ms, info %.1f ms; %llu bytes, %.1f a point, %.1f a leaf, depth %u\n",
                median(opening) * 1e3, median(info) * 1e3,
                static_cast<unsigned long long>(statistics.bytes),
                static_cast<double>(statistics.bytes) / points, statistics.bytes_per_leaf,
                statistics.grid.depth);
    const double checking = seconds([&] {
        for (const std::string& failure : check_octree_file(svo))
            std::printf("%s\n", failure.c_str());
    });
    std::printf("  check %.2f s; peak memory of all of this %ld MB\n", checking, peak_megabytes());
    fs::remove(ply);
    fs::remove(svo);
}
