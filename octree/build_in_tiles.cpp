#include "octree/build_in_tiles.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "octree/error.h"
#include "octree/join.h"
#include "octree/resident_memory.h"
#include "octree/size_estimate.h"
#include "octree/spill.h"
#include "octree/tiling.h"
#include "octree/write_packing.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kMegabyte = 1000000;
constexpr std::uint64_t kLeastRoom = 48 * kMegabyte;  ///< for a tile and the buffers

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

    /// `summary` is of the whole stream. Only usable surfels come, their values in range where
    /// there is a radius for those without one.
    template <typename Visit>
    void run_usable(const CloudSummary& summary, const Visit& visit) {
        run([&](std::span<const Surfel> batch) {
            for (Surfel s : batch) {
                if (!is_usable(s)) continue;
                if (summary.needs_repair && summary.median_radius > 0.0)
                    repair(s, summary.median_radius);
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

class TiledBuild {
  public:
    TiledBuild(const SurfelStream& stream, const BuildSettings& settings,
               const MemorySettings& memory, const std::filesystem::path& path,
               const Progress& progress)
        : stream_(stream),
          settings_(settings),
          memory_(memory),
          path_(path),
          root_(settings.tile.value_or(OctreeCell{})),
          fixed_(resident_bytes() + kOwnBytes),
          passes_(stream, progress, 4) {}

    BuildFileReport run() {
        if (memory_.limit < fixed_ + kLeastRoom) {
            refuse("a memory limit of " + std::to_string(memory_.limit / kMegabyte) +
                   " MB is too small: it takes " +
                   std::to_string((fixed_ + kLeastRoom) / kMegabyte + 1) + " MB at the least");
        }
        CloudSummarizer summarizer;
        passes_.run([&](std::span<const Surfel> batch) { summarizer.add(batch); });
        summary_ = summarizer.finish();
        const std::uint64_t needed = fixed_ + memory_to_build(summary_.usable + summary_.dropped);
        if (summary_.median_radius == 0.0 && !settings_.tile && needed <= memory_.limit)
            return build_one();
        require_radii();
        settings_.grid = fit_grid(summary_, stream_.origin, settings_);
        if (!settings_.tile) require_room(summary_, *settings_.grid, path_);

        CellWeights weights(*settings_.grid, root_);
        passes_.run_usable(summary_, [&](const Surfel& s) { weights.add(s); });
        if (fixed_ + weights.total() <= memory_.limit) return build_one();
        return build_tiles(Tiling(weights, (memory_.limit - fixed_) * 3 / 4, fixed_));
    }

  private:
    [[noreturn]] static void refuse(const std::string& why) {
        throw Error(ExitCode::kBudget, why + "; raise --memory-limit");
    }

    SurfelCloud empty_cloud() const {
        return {stream_.origin, {}, stream_.stations, stream_.area_lights};
    }
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
        SurfelCloud cloud = empty_cloud();
        if (!settings_.tile) cloud.surfels.reserve(summary_.usable);
        passes_.run_usable(summary_, [&](const Surfel& s) {
            if (!settings_.tile || reaches(s, *settings_.grid, root_)) cloud.surfels.push_back(s);
        });
        if (cloud.surfels.empty()) refuse_empty();
        CloudSummary summary = summarize(cloud.surfels);
        UnpackedOctree built =
            build_tree(std::move(cloud), std::move(summary), settings_, passes_.standing());
        built.octree.dropped_count = dropped();
        return write_packing(built, path_, passes_.standing(), true);
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
        report.memory_limit = memory_.limit;
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
            SurfelCloud cloud = empty_cloud();
            const std::uint64_t size = spills[t].size();
            cloud.surfels = spills[t].take();
            tile_settings.tile = tiling.tiles()[t];
            const auto file = folder.path() / ("tile" + std::to_string(t) + ".svo");
            CloudSummary summary = summarize(cloud.surfels);
            write_packing(
                build_tree(std::move(cloud), std::move(summary), tile_settings, passes_.standing()),
                file, passes_.standing(), false);
            built.push_back(OctreeFile::open(file));
            passes_.advance(size);
        }
        return built;
    }

    const SurfelStream& stream_;
    BuildSettings settings_;
    const MemorySettings& memory_;
    const std::filesystem::path& path_;
    OctreeCell root_;
    std::uint64_t fixed_;  ///< bytes that do not depend on the points
    Passes passes_;
    CloudSummary summary_;
};

}  // namespace

BuildFileReport build_in_tiles(const SurfelStream& stream, const BuildSettings& settings,
                               const MemorySettings& memory, const std::filesystem::path& path,
                               const Progress& progress) {
    return TiledBuild(stream, settings, memory, path, progress).run();
}

}  // namespace glowworm
