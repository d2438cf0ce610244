// Points per second of the scan readers on 5 million points, beside two passes over the same bytes:
// `cat` (read into one buffer) and `copy` (read, then memcpy into fresh memory of the file's size).
// `stream` reads block by block, `scans` into memory as the commands do. Peak memory is what the
// measured calls added to the process. Usage: read_bench [benchmark flags] [scan files...]

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "octree/atomic_file.h"
#include "preprocess/read/input_file.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/write/cloud_writer.h"

namespace {

using namespace glowworm;
namespace fs = std::filesystem;

constexpr std::size_t kPoints = 5'000'000;
constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

/// A room of 20 m with the millimetres, colours and intensities of a scan.
PointCloud some_cloud() {
    std::mt19937 random(5);
    std::uniform_real_distribution<float> coordinate(-10.0f, 10.0f);
    PointCloud cloud;
    for (std::size_t i = 0; i < kPoints; ++i) {
        cloud.points.positions.push_back({coordinate(random), coordinate(random), 2.0f});
        cloud.points.colours.push_back(
            {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8), 128});
        cloud.points.intensities.push_back(static_cast<float>(i % 2048));
    }
    return cloud;
}

void write_text(const PointCloud& cloud, const fs::path& path) {
    AtomicFile file(path);
    std::string text;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
        const Vec3f& p = cloud.points.positions[i];
        const Rgb8& c = cloud.points.colours[i];
        text += fmt::format("{:.4f} {:.4f} {:.4f} {} {} {} {}\n", p.x, p.y, p.z,
                            static_cast<int>(cloud.points.intensities[i]), c.r, c.g, c.b);
        if (text.size() < kBufferBytes) continue;
        file.write(text);
        text.clear();
    }
    file.write(text);
    file.commit();
}

/// kB of the process's status, "VmHWM" or "VmRSS".
double status_kb(const std::string& key) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with(key)) return std::stod(line.substr(key.size() + 1));
    }
    return 0.0;
}

/// Runs `pass` as often as asked; it returns how many points it read, 0 where it knows only bytes.
template <typename Pass>
void measure(benchmark::State& state, const fs::path& path, Pass pass) {
    ::malloc_trim(0);
    std::ofstream("/proc/self/clear_refs") << 5;  // forget the peak so far
    const double before = status_kb("VmRSS");
    std::size_t points = 0;
    for (auto _ : state)
        points = pass();
    const auto iterations = static_cast<std::int64_t>(state.iterations());
    state.SetBytesProcessed(iterations * static_cast<std::int64_t>(fs::file_size(path)));
    state.SetItemsProcessed(iterations * static_cast<std::int64_t>(points));
    state.counters["peak_MB"] = (status_kb("VmHWM") - before) / 1024.0;
}

std::size_t cat(const fs::path& path) {
    const InputFile file(path);
    std::vector<char> buffer(kBufferBytes);
    for (std::uint64_t at = 0; at < file.size(); at += buffer.size()) {
        benchmark::DoNotOptimize(file.read_some(at, buffer.data(), buffer.size()));
    }
    return 0;
}

std::size_t copy(const fs::path& path) {
    const InputFile file(path);
    std::vector<char> buffer(kBufferBytes), copied;
    copied.reserve(file.size());
    for (std::uint64_t at = 0; at < file.size(); at += buffer.size()) {
        const std::size_t got = file.read_some(at, buffer.data(), buffer.size());
        copied.insert(copied.end(), buffer.data(), buffer.data() + got);
    }
    benchmark::DoNotOptimize(copied.data());
    return 0;
}

std::size_t stream(const fs::path& path) {
    const auto file = open_scan_file(path);
    ScanHeader header;
    PointBlock block;
    std::size_t points = 0;
    while (file->next_scan(header)) {
        while (file->next_block(block))
            points += block.size();
    }
    return points;
}

std::size_t scans(const fs::path& path) {
    std::size_t points = 0;
    for (const Scan& scan : read_scans(path))
        points += scan.points.size();
    return points;
}

void add_file(const fs::path& path) {
    struct Kind {
        const char* name;
        std::size_t (*pass)(const fs::path& path);
    };
    for (const Kind& kind :
         {Kind{"cat", cat}, {"copy", copy}, {"stream", stream}, {"scans", scans}}) {
        benchmark::RegisterBenchmark((path.filename().string() + "/" + kind.name).c_str(),
                                     [path, pass = kind.pass](benchmark::State& state) {
                                         measure(state, path, [&] { return pass(path); });
                                     })
            ->Unit(benchmark::kMillisecond);
    }
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    const fs::path folder = fs::temp_directory_path() / "glowworm-read-bench";
    fs::create_directories(folder);
    {
        const PointCloud cloud = some_cloud();
        for (const char* name : {"scan.ply", "scan.pcd", "scan.las", "scan.e57", "scan.xyz"}) {
            if (std::string(name) == "scan.xyz")
                write_text(cloud, folder / name);
            else
                write_cloud(cloud, folder / name);
            add_file(folder / name);
        }
    }
    for (int i = 1; i < argc; ++i)
        add_file(argv[i]);
    benchmark::RunSpecifiedBenchmarks();
    fs::remove_all(folder);
}
