#include "preprocess/surface/surfel_file.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "octree/build_file.h"
#include "octree/error.h"
#include "preprocess/read/append_block.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/surface/albedo.h"

namespace glowworm {
namespace {

constexpr std::size_t kBatch = 65536;
constexpr std::size_t kBlocksAtOnce = 3;  ///< of 65536 points: 10 MB each while they are converted
constexpr std::uint64_t kBytesPerPoint = 100;  ///< of a PointCloud's columns, with their growth

/// How the points of a file become surfels: the same for every block.
struct Conversion {
    std::filesystem::path path;
    ReadSettings settings;
    Vec3d offset;         ///< m: taken out of every position before it becomes float
    Rgb8 default_albedo;  ///< where the file has no colour
    bool coloured = false;
    std::size_t stations = 0;  ///< that the file names; 0: its station column means nothing here
};

/// A point that is nowhere or absurdly far stays without a position, so that whoever builds drops
/// and counts it.
void to_points(PointBlock& block, const Conversion& conversion, Points& points) {
    points.positions.clear();
    points.normals.clear();
    points.colours.clear();
    points.ndf_lengths.clear();
    points.radii.clear();
    points.stations.clear();
    points.emissions.clear();
    block.intensities.clear();
    block.times.clear();
    block.grid.clear();
    if (conversion.stations == 0) block.stations.clear();
    for (Vec3d& p : block.positions) {
        if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > kFarthestMetres)
            p.x = std::numeric_limits<double>::quiet_NaN();
    }
    append_block(block, conversion.offset, points);
    for (const std::uint32_t station : points.stations) {
        if (station < conversion.stations) continue;
        throw Error(ExitCode::kUnreadable, "cannot read '" + conversion.path.string() +
                                               "': a point of it was seen from station " +
                                               std::to_string(station) + " but it names only " +
                                               std::to_string(conversion.stations) +
                                               "; merge the scans again");
    }
}

void read_surfels(const Conversion& conversion,
                  const std::function<void(std::span<const Surfel>)>& visit) {
    const std::unique_ptr<ScanFile> file = open_scan_file(conversion.path, conversion.settings);
    ScanHeader header;
    file->next_scan(header);
    // One block is read while another is converted and a third is used.
    const auto read = [&](tbb::flow_control& flow) {
        auto block = std::make_shared<PointBlock>();
        if (!file->next_block(*block)) flow.stop();
        return block;
    };
    const auto convert = [&](const std::shared_ptr<PointBlock>& block) {
        Points points;
        to_points(*block, conversion, points);
        auto surfels = std::make_shared<std::vector<Surfel>>(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            (*surfels)[i] =
                to_surfel(points, i, points.radii[i],
                          conversion.coloured ? points.colours[i] : conversion.default_albedo);
        }
        return surfels;
    };
    using Block = std::shared_ptr<PointBlock>;
    using Surfels = std::shared_ptr<std::vector<Surfel>>;
    using tbb::filter_mode;
    tbb::parallel_pipeline(
        kBlocksAtOnce,
        tbb::make_filter<void, Block>(filter_mode::serial_in_order, read) &
            tbb::make_filter<Block, Surfels>(filter_mode::parallel, convert) &
            tbb::make_filter<Surfels, void>(filter_mode::serial_in_order,
                                            [&](const Surfels& surfels) { visit(*surfels); }));
}

/// Whether any point has a colour: a scanner that took no pictures often writes black.
bool is_black(const PointBlock& block) {
    return std::ranges::all_of(block.colours, [](const Rgb8& c) { return c == Rgb8{}; });
}

/// The cloud as a stream from its file; nothing where its points cannot be told one by one.
std::optional<SurfelFile> stream_from_file(const std::filesystem::path& path,
                                           const ReadSettings& settings, float default_albedo) {
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    const std::string format = file->format().name;
    if (format != "PLY" && format != "PCD") return {};  // others may hold several scans
    ScanHeader header;
    if (!file->next_scan(header)) return {};
    const ColumnSet& columns = header.columns;
    const bool complete = columns.normals && columns.radii && !header.T_world_scan &&
                          (columns.colours || !columns.intensities);
    if (!complete) return {};

    // The first points choose the offset, as where a cloud is read as a whole.
    PointBlock block;
    Conversion conversion{path, settings, {}, {}, false, header.stations.size()};
    bool chosen = false;
    while ((!chosen || (columns.colours && !conversion.coloured)) && file->next_block(block)) {
        conversion.coloured = conversion.coloured || !is_black(block);
        drop_not_finite(block);
        drop_too_far(block);
        if (chosen || block.size() == 0) continue;
        conversion.offset = choose_offset(block);
        chosen = true;
    }
    if (!chosen || (columns.colours && !conversion.coloured)) return {};

    conversion.default_albedo = to_srgb({default_albedo, default_albedo, default_albedo});
    SurfelFile result;
    result.stream.origin = header.origin + conversion.offset;
    result.stream.stations = header.stations;
    result.stream.area_lights = header.area_lights;
    result.stream.expected = header.declared_points;
    result.stream.for_each = [conversion](const auto& visit) { read_surfels(conversion, visit); };
    result.defaults = {!columns.ndf_lengths, false, !columns.colours, 0};
    return result;
}

void require_room(const std::filesystem::path& path, const ReadSettings& settings,
                  std::uint64_t limit) {
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    std::uint64_t points = 0;
    ScanHeader header;
    while (file->next_scan(header))
        points += header.declared_points;
    const std::uint64_t bytes = memory_to_build(points) + points * kBytesPerPoint;
    if (bytes <= limit) return;
    throw Error(ExitCode::kBudget,
                "'" + path.string() +
                    "' lacks radii or colours or holds several scans, so all its points must be in "
                    "memory at once, which takes " +
                    std::to_string(bytes >> 20) +
                    " MB; run `glowworm surface` on it first or "
                    "raise --memory-limit");
}

}  // namespace

SurfelFile open_surfels(const std::filesystem::path& path, const ReadSettings& settings,
                        float default_albedo, std::uint64_t memory_limit) {
    if (auto streamed = stream_from_file(path, settings, default_albedo)) return *streamed;
    if (memory_limit > 0) require_room(path, settings, memory_limit);

    SurfelFile result;
    ReadReport report;
    auto cloud = std::make_shared<SurfelCloud>(
        to_surfels(read_cloud(path, settings, &report), default_albedo, &result.defaults));
    for (const ScanCounts& scan : report.scans)
        result.stream.dropped += scan.not_finite + scan.too_far;
    result.in_memory = true;
    result.stream.dropped += result.defaults.dropped;
    result.stream.origin = cloud->origin;
    result.stream.stations = cloud->stations;
    result.stream.area_lights = cloud->area_lights;
    result.stream.expected = cloud->surfels.size();
    result.stream.for_each = [cloud](const auto& visit) {
        const std::span<const Surfel> all = cloud->surfels;
        for (std::size_t at = 0; at < all.size(); at += kBatch)
            visit(all.subspan(at, std::min(kBatch, all.size() - at)));
    };
    return result;
}

}  // namespace glowworm
