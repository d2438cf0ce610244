#include "preprocess/pipeline/look.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>

#include "preprocess/pipeline/for_all_files.h"
#include "preprocess/read/append_block.h"
#include "preprocess/read/kept_blocks.h"
#include "preprocess/station.h"

namespace glowworm {
namespace {

/// The finaliser of SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t mixed(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

/// Keeps the points of the least hashes: an even sample that depends on nothing but the positions.
class EvenSample {
  public:
    void add(const Vec3f& p) {
        std::uint64_t hash = 0x9e3779b97f4a7c15u;
        for (const float value : {p.x, p.y, p.z})
            hash = mixed(hash + std::bit_cast<std::uint32_t>(value + 0.0f));
        if (hash > limit_) return;
        kept_.push_back({hash, p});
        if (kept_.size() <= kLookedPoints) return;
        limit_ /= 2;
        std::erase_if(kept_, [this](const auto& entry) { return entry.first > limit_; });
    }
    std::vector<Vec3f> take() const {
        std::vector<Vec3f> positions;
        for (const auto& [hash, position] : kept_)
            positions.push_back(position);
        return positions;
    }

  private:
    std::vector<std::pair<std::uint64_t, Vec3f>> kept_;  // in the order of the file
    std::uint64_t limit_ = UINT64_MAX;
};

std::vector<LookedScan> look_at_file(const std::filesystem::path& path,
                                     const ReadSettings& settings) {
    std::vector<LookedScan> scans;
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    ScanHeader header;
    PointBlock block;
    while (file->next_scan(header)) {
        LookedScan& looked = scans.emplace_back();
        looked.facts.counts.declared = header.declared_points;
        looked.facts.has_pose = header.T_world_scan.has_value();
        looked.facts.crs = header.crs;
        FactsCollector collector;
        EvenSample sample;
        KeptBlocks blocks(*file, looked.facts.counts);
        Vec3d offset;
        for (bool chosen = false; blocks.next(block);) {
            if (block.size() == 0) continue;
            if (!chosen) offset = choose_offset(block);
            chosen = true;
            collector.add(block, header.origin);
            for (const Vec3d& p : block.positions)
                sample.add(vec3_cast<float>(p - offset));
        }
        collector.finish(looked.facts);
        looked.places = collector.spread_points();
        looked.sample.file = path;
        looked.sample.offset = header.origin + offset;
        looked.sample.points.positions = sample.take();
        looked.sample.T_world_scan = header.T_world_scan;
        looked.sample.has_viewpoint =
            header.has_viewpoint ||
            (offset == Vec3d{} && origin_is_viewpoint(looked.sample.points));
    }
    for (std::size_t i = 0; i < scans.size(); ++i) {
        std::string name = path.filename().string();
        if (scans.size() > 1) name += "#" + std::to_string(i + 1);
        scans[i].sample.name = scans[i].facts.counts.name = std::move(name);
    }
    std::erase_if(scans, [](const LookedScan& scan) { return scan.facts.counts.kept == 0; });
    return scans;
}

/// The points of `block` at `indices`, all columns, appended to `scan`.
void append_some(const PointBlock& block, const std::vector<std::uint32_t>& indices,
                 const Vec3d& offset, Scan& scan) {
    Points all;
    append_block(block, offset, all);
    scan.points.append(indices.size() == all.size() ? all : all.select(indices));
}

/// The scans of one file from number `first` on.
std::vector<Scan> pick_from_file(const std::filesystem::path& path, const ReadSettings& settings,
                                 std::span<LookedScan> looked, std::size_t first,
                                 const Wanted& wanted) {
    std::vector<Scan> picked;
    const std::unique_ptr<ScanFile> file = open_scan_file(path, settings);
    ScanHeader header;
    PointBlock block;
    std::vector<std::uint32_t> indices;
    while (picked.size() < looked.size() && file->next_scan(header)) {
        LookedScan& of = looked[picked.size()];
        Scan scan = of.sample;
        scan.points = {};
        ScanCounts counts;
        SpacingCollector spacing(of.places);
        KeptBlocks blocks(*file, counts);
        while (blocks.next(block)) {
            indices.clear();
            for (std::uint32_t i = 0; i < block.size(); ++i) {
                if (wanted(first + picked.size(), header.origin + block.positions[i]))
                    indices.push_back(i);
            }
            spacing.add(block.positions, header.origin);
            if (!indices.empty()) append_some(block, indices, scan.offset - header.origin, scan);
        }
        if (counts.kept == 0) continue;
        of.facts.spacing = spacing.median();
        picked.push_back(std::move(scan));
    }
    return picked;
}

/// Of two passes over the files, the first (0) or the second (1).
Progress half(const Progress& progress, std::uint64_t which) {
    if (!progress) return {};
    return [&progress, which](std::uint64_t done, std::uint64_t files) {
        progress(which * files + done, 2 * files);
    };
}

template <typename T>
std::vector<T> joined(std::vector<std::vector<T>> of_files) {
    std::vector<T> all;
    for (std::vector<T>& scans : of_files)
        std::ranges::move(scans, std::back_inserter(all));
    return all;
}

}  // namespace

std::vector<LookedScan> look_at(std::span<const std::filesystem::path> files,
                                const ReadSettings& settings, const Progress& progress) {
    return joined(for_all_files(files.size(), half(progress, 0),
                                [&](std::size_t i) { return look_at_file(files[i], settings); }));
}

std::vector<Scan> pick_points(std::span<const std::filesystem::path> files,
                              const ReadSettings& settings, std::vector<LookedScan>& looked,
                              const Wanted& wanted, const Progress& progress) {
    std::vector<std::size_t> first(files.size() + 1, looked.size());
    for (std::size_t i = files.size(), scan = looked.size(); i-- > 0;) {
        while (scan > 0 && looked[scan - 1].sample.file == files[i])
            --scan;
        first[i] = scan;
    }
    return joined(for_all_files(files.size(), half(progress, 1), [&](std::size_t i) {
        const auto own = std::span(looked).subspan(first[i], first[i + 1] - first[i]);
        return pick_from_file(files[i], settings, own, first[i], wanted);
    }));
}

}  // namespace glowworm
