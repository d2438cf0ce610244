#include "preprocess/register/align.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "octree/error.h"
#include "preprocess/register/assembly.h"
#include "preprocess/register/candidates.h"
#include "preprocess/register/features.h"
#include "preprocess/register/frames.h"
#include "preprocess/register/report.h"

namespace glowworm {
namespace {

constexpr int kLoopRounds = 2;

void check(std::span<const Scan> scans, const RegistrationSettings& settings) {
    if (scans.empty()) throw Error(ExitCode::kDegenerate, "there are no scans to register");
    if (scans.size() > settings.max_scans) {
        throw Error(ExitCode::kUsage,
                    fmt::format("{} scans are more than the limit of {}; register "
                                "them in parts",
                                scans.size(), settings.max_scans));
    }
    if (settings.voxel_size < 0.0 || !std::isfinite(settings.voxel_size)) {
        throw Error(ExitCode::kUsage, "the registration voxel size must be a length in metres");
    }
    for (const Scan& scan : scans) {
        const bool any = std::any_of(scan.points.positions.begin(), scan.points.positions.end(),
                                     [](const Vec3f& p) { return is_finite(p); });
        if (any) continue;
        throw Error(ExitCode::kDegenerate,
                    fmt::format("{} holds no points, so it cannot be registered; leave it out",
                                pose_file(scan)));
    }
}

/// Counts work done by many threads and passes it on one call at a time.
class SharedProgress {
  public:
    SharedProgress(const Progress& progress, std::uint64_t total)
        : progress_(progress), total_(total) {}
    void grow(std::uint64_t more) { total_ += more; }
    void step() {
        const std::lock_guard lock(mutex_);
        ++done_;
        if (progress_) progress_(done_, total_);
    }

  private:
    const Progress& progress_;
    std::mutex mutex_;
    std::uint64_t done_ = 0, total_;
};

}  // namespace

Registration align_scans(std::span<const Scan> scans, const RegistrationSettings& settings,
                         const Progress& progress) {
    check(scans, settings);
    Registration result;
    result.voxel_size = settings.voxel_size > 0.0 ? settings.voxel_size
                                                  : choose_voxel_size(scans, settings.upright);
    const PairSettings pair_settings{.voxel_size = result.voxel_size, .upright = settings.upright};
    const LocalFrame frame = choose_frame(scans, settings);
    const std::size_t n = scans.size();

    // 1. What each scan's surface looks like. Nobody has to look where all poses are trusted.
    SharedProgress shared(progress, n);
    std::vector<ScanModel> models(n);
    const bool all_seen = std::all_of(scans.begin(), scans.end(),
                                      [](const Scan& scan) { return scan.has_viewpoint; });
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
        models[i] = model_scan(scans[i], result.voxel_size, settings.upright, all_seen);
        if (n > 1 && !frame.all_given) models[i].keypoints = describe(models[i].coarse);
        shared.step();
    });

    // 2. Pairs from given poses, then those that have none or did not hold from nothing.
    Assembly assembly = start_assembly(models, frame, settings);
    std::vector<PairFit> pairs = given_pairs(models, frame, pair_settings, settings);
    assemble(models, pairs, pair_settings, assembly);
    const std::vector<std::pair<std::size_t, std::size_t>> candidates =
        candidate_pairs(models, pairs, assembly, pair_settings, settings);
    result.pairs_tried = pairs.size() + candidates.size();
    shared.grow(candidates.size());
    std::vector<PairFit> found(candidates.size());
    tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
        const auto [target, source] = candidates[i];
        found[i] = align_pair(models[source], models[target], pair_settings);
        found[i].source = source;
        found[i].target = target;
        shared.step();
    });
    pairs.insert(pairs.end(), found.begin(), found.end());

    // 3. Together: join, close loops, let the pose graph settle.
    assemble(models, pairs, pair_settings, assembly);
    settle(pairs, pair_settings, frame.fixed, assembly);
    for (int round = 0; round < kLoopRounds; ++round) {
        const std::vector<PairFit> loops = close_loops(models, pairs, pair_settings, assembly);
        if (loops.empty()) break;
        pairs.insert(pairs.end(), loops.begin(), loops.end());
        settle(pairs, pair_settings, frame.fixed, assembly);
    }

    // 4. What came of it, in the world's frame.
    write_report(scans, models, pairs, pair_settings, frame, assembly, result);
    return result;
}

}  // namespace glowworm
