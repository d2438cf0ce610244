#include "octree/build_file.h"

#include <algorithm>
#include <string>
#include <vector>

#include "octree/error.h"
#include "octree/join.h"
#include "octree/octree_writer.h"
#include "octree/resident_memory.h"
#include "octree/size_estimate.h"
#include "octree/spill.h"
#include "octree/tiling.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kMegabyte = 1000000;
constexpr std::uint64_t kLeastRoom = 48 * kMegabyte;     ///< for a tile and the buffers
constexpr std::uint64_t kOwnBytes = 24 * kMegabyte;      ///< blocks being read, threads, joining
constexpr std::uint64_t kProgramBytes = 64 * kMegabyte;  ///< code and libraries, before any work

/// Passes over a stream, each telling how far it is of all of them.
class Passes {
  public:
    Passes(const SurfelStream& stream, const Progress& progress, std::uint64_t passes)
        : stream_(stream), progress_(progress), passes_(passes) {}

    template <typename Visit>
    void run(const Visit& visit) {
        stream_.for_each([&](std::span<const Surfel> batch) {
            visit(batch);
            advance(batch.size());
        });
    }

    /// `summary` is of the whole stream. Only usable surfels come, their values in range.
    template <typename Visit>
    void run_usable(const CloudSummary& summary, const Visit& visit) {
        run([&](std::span<const Surfel> batch) {
            for (Surfel s : batch) {
                if (!is_usable(s)) continue;
                if (summary.needs_repair) repair(s, summary.median_radius);
                visit(s);
            }
        });
    }

    void advance(std::uint64_t surfels) {
        done_ += surfels;
        const std::uint64_t total = std::max(total_, std::max(stream_.expected, done_ / passes_));
        total_ = total;
        if (progress_) progress_(std::min(total, done_ / passes_), total);
    }

    /// For work between the passes: tells how far they are, so that it can be cancelled.
    Progress standing() {
        return [this](std::uint64_t, std::uint64_t) { advance(0); };
    }

  private:
    const SurfelStream& stream_;
    const Progress& progress_;
    std::uint64_t passes_, done_ = 0, total_ = 0;
};

/// What is the same for every way to build.
SurfelCloud empty_cloud(const SurfelStream& stream) {
    return {stream.origin, {}, stream.stations, stream.area_lights};
}

void write(Octree octree, std::uint64_t dropped, const std::filesystem::path& path,
           const Progress& progress, BuildFileReport& report) {
    octree.dropped_count = dropped;
    report.samples = octree.sample_count;
    report.dropped = dropped;
    report.grid = octree.grid;
    write_octree_file(octree.view(), path, {.progress = all_done(progress, octree.sample_count)});
}

BuildFileReport build_at_once(const SurfelStream& stream, const BuildSettings& settings,
                              const std::filesystem::path& path, const Progress& progress) {
    SurfelCloud cloud = empty_cloud(stream);
    cloud.surfels.reserve(stream.expected);
    stream.for_each([&](std::span<const Surfel> batch) {
        if (progress) progress(0, std::max<std::uint64_t>(stream.expected, 1));
        cloud.surfels.insert(cloud.surfels.end(), batch.begin(), batch.end());
    });
    if (settings.depth || settings.voxel_size || settings.grid) {
        // The automatic depth makes no leaves smaller than the samples.
        const CloudSummary summary = summarize(cloud.surfels);
        if (summary.usable > 0)
            require_room(summary, fit_grid(summary, cloud.origin, settings), true, path);
    }
    BuildFileReport report;
    Octree octree = build_octree(std::move(cloud), settings, progress);
    const std::uint64_t dropped = stream.dropped + octree.dropped_count;
    write(std::move(octree), dropped, path, progress, report);
    return report;
}

class LimitedBuild {
  public:
    LimitedBuild(const SurfelStream& stream, const BuildSettings& settings,
                 const MemorySettings& memory, const std::filesystem::path& path,
                 const Progress& progress)
        : stream_(stream),
          settings_(settings),
          memory_(memory),
          path_(path),
          progress_(progress),
          root_(settings.tile.value_or(OctreeCell{})),
          fixed_(resident_bytes() + kOwnBytes),
          passes_(stream, progress, 4) {}

    BuildFileReport run() {
        if (limited() && memory_.limit < fixed_ + kLeastRoom) {
            refuse("a memory limit of " + std::to_string(memory_.limit / kMegabyte) +
                   " MB is too small: it takes " +
                   std::to_string((fixed_ + kLeastRoom) / kMegabyte + 1) + " MB at the least");
        }
        CloudSummarizer summarizer;
        passes_.run([&](std::span<const Surfel> batch) { summarizer.add(batch); });
        summary_ = summarizer.finish();
        const std::uint64_t needed = fixed_ + memory_to_build(summary_.usable + summary_.dropped);
        if (summary_.median_radius == 0.0 && !settings_.tile && needed <= memory_.limit)
            return build_at_once(stream_, settings_, path_, progress_);
        require_radii();
        settings_.grid = fit_grid(summary_, stream_.origin, settings_);
        if (!settings_.tile) require_room(summary_, *settings_.grid, !limited(), path_);

        CellWeights weights(*settings_.grid, root_);
        passes_.run_usable(summary_, [&](const Surfel& s) { weights.add(s); });
        if (!limited() || fixed_ + weights.total() <= memory_.limit) return build_one();
        return build_tiles(Tiling(weights, (memory_.limit - fixed_) * 3 / 4, fixed_));
    }

  private:
    [[noreturn]] static void refuse(const std::string& why) {
        throw Error(ExitCode::kBudget, why + "; raise --memory-limit");
    }

    bool limited() const { return memory_.limit > 0; }
    std::uint64_t dropped() const { return stream_.dropped + summary_.dropped; }

    void require_radii() const {
        if (summary_.usable == 0) {
            throw Error(ExitCode::kDegenerate,
                        "the cloud has no point with a finite position and a normal; run "
                        "`glowworm surface` on it");
        }
        if (summary_.median_radius > 0.0) return;
        throw Error(settings_.tile ? ExitCode::kUsage : ExitCode::kBudget,
                    "the points have no radius, and finding their spacing takes all of them at "
                    "once; run `glowworm surface` first" +
                        std::string(settings_.tile ? "" : " or raise --memory-limit"));
    }

    BuildFileReport build_one() {
        SurfelCloud cloud = empty_cloud(stream_);
        passes_.run_usable(summary_, [&](const Surfel& s) {
            if (reaches(s, *settings_.grid, root_)) cloud.surfels.push_back(s);
        });
        BuildFileReport report;
        if (cloud.surfels.empty()) refuse_empty();
        const Progress still_here = passes_.standing();
        Octree octree = build_octree(std::move(cloud), settings_, still_here);
        write(std::move(octree), dropped(), path_, still_here, report);
        return report;
    }

    [[noreturn]] static void refuse_empty() {
        throw Error(ExitCode::kDegenerate,
                    "the tile has no points and no surface; leave it out when joining");
    }

    BuildFileReport build_tiles(const Tiling& tiling) {
        const std::filesystem::path beside = path_.has_parent_path() ? path_.parent_path() : ".";
        const TemporaryFolder folder(memory_.temporary_folder.empty() ? beside
                                                                      : memory_.temporary_folder);
        BuildFileReport report;
        std::vector<Spill> spills = spread(tiling, folder, report);
        const std::vector<OctreeFile> built = build_each(tiling, folder, spills);
        if (built.empty()) refuse_empty();
        report.grid = *settings_.grid;
        report.tiles = static_cast<std::uint32_t>(built.size());
        for (const OctreeFile& tile : built)
            report.samples += tile.view().sample_count;
        report.dropped = dropped();
        join_octrees(built, {settings_.provenance, dropped(), passes_.standing()}, path_);
        return report;
    }

    /// An eighth of the limit goes into the buffers.
    std::vector<Spill> spread(const Tiling& tiling, const TemporaryFolder& folder,
                              BuildFileReport& report) {
        std::vector<Spill> spills;
        const std::uint64_t buffered =
            (memory_.limit - fixed_) / 8 / sizeof(Surfel) / tiling.tiles().size();
        for (std::size_t t = 0; t < tiling.tiles().size(); ++t) {
            spills.emplace_back(folder.path() / ("spill" + std::to_string(t)),
                                std::clamp<std::uint64_t>(buffered, 16, 65536));
        }
        std::vector<std::uint32_t> reached;
        passes_.run_usable(summary_, [&](const Surfel& s) {
            tiling.find(s, reached);
            for (const std::uint32_t tile : reached)
                spills[tile].add(s);
            report.spilled_bytes += reached.size() * sizeof(Surfel);
        });
        return spills;
    }

    std::vector<OctreeFile> build_each(const Tiling& tiling, const TemporaryFolder& folder,
                                       std::vector<Spill>& spills) {
        std::vector<OctreeFile> built;
        BuildSettings tile_settings = settings_;
        tile_settings.provenance = "{}";
        for (std::size_t t = 0; t < spills.size(); ++t) {
            if (spills[t].size() == 0) continue;
            SurfelCloud cloud = empty_cloud(stream_);
            const std::uint64_t size = spills[t].size();
            cloud.surfels = spills[t].take();
            tile_settings.tile = tiling.tiles()[t];
            const auto file = folder.path() / ("tile" + std::to_string(t) + ".svo");
            Octree octree = build_octree(std::move(cloud), tile_settings, passes_.standing());
            write_octree_file(octree.view(), file,
                              {.progress = passes_.standing(), .synced = false});
            built.push_back(OctreeFile::open(file));
            passes_.advance(size);
        }
        return built;
    }

    const SurfelStream& stream_;
    BuildSettings settings_;
    const MemorySettings& memory_;
    const std::filesystem::path& path_;
    const Progress& progress_;
    OctreeCell root_;
    std::uint64_t fixed_;  ///< bytes that do not depend on the points
    Passes passes_;
    CloudSummary summary_;
};

}  // namespace

std::uint64_t memory_to_build(std::uint64_t surfels) {
    return kProgramBytes + kOwnBytes + surfels * kBytesPerSurfel;
}

BuildFileReport build_octree_file(const SurfelStream& stream, const BuildSettings& settings,
                                  const MemorySettings& memory, const std::filesystem::path& path,
                                  const Progress& progress) {
    if (settings.tile) require_tile(settings);
    if (memory.limit == 0 && !settings.tile) return build_at_once(stream, settings, path, progress);
    return LimitedBuild(stream, settings, memory, path, progress).run();
}

}  // namespace glowworm
