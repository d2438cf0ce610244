#include "preprocess/register/align.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <map>
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

using ScanPair = std::pair<std::size_t, std::size_t>;  // target, source

/// What is known before any pair is tried from nothing.
struct Beginning {
    PairSettings pair_settings;
    LocalFrame frame;
    bool all_seen = false;
    std::vector<ScanModel> models;
    Assembly assembly;
    std::vector<PairFit> pairs;  ///< from given poses
    std::vector<ScanPair> candidates;
};

Beginning begin(std::span<const Scan> scans, const RegistrationSettings& settings,
                SharedProgress& shared) {
    check(scans, settings);
    const double voxel_size = settings.voxel_size > 0.0
                                  ? settings.voxel_size
                                  : choose_voxel_size(scans, settings.upright);
    Beginning begun;
    begun.pair_settings = {.voxel_size = voxel_size, .upright = settings.upright};
    begun.frame = choose_frame(scans, settings);
    const std::size_t n = scans.size();

    // 1. What each scan's surface looks like. Nobody has to look where all poses are trusted.
    begun.models.resize(n);
    begun.all_seen = std::all_of(scans.begin(), scans.end(),
                                 [](const Scan& scan) { return scan.has_viewpoint; });
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
        ScanModel& model = begun.models[i];
        model = model_scan(scans[i], voxel_size, settings.upright, begun.all_seen);
        if (n > 1 && !begun.frame.all_given) model.keypoints = describe(model.wide);
        shared.step();
    });

    // 2. Pairs from given poses, and which of the others are worth an attempt.
    begun.assembly = start_assembly(begun.models, begun.frame, settings);
    begun.pairs = given_pairs(begun.models, begun.frame, begun.pair_settings, settings);
    assemble(begun.models, begun.pairs, begun.pair_settings, begun.assembly);
    begun.candidates =
        candidate_pairs(begun.models, begun.pairs, begun.assembly, begun.pair_settings, settings);
    return begun;
}

std::vector<PairFit> align_pairs(std::span<const ScanModel> models, std::span<const ScanPair> pairs,
                                 const PairSettings& settings, SharedProgress& shared) {
    std::vector<PairFit> found(pairs.size());
    tbb::parallel_for(std::size_t{0}, pairs.size(), [&](std::size_t i) {
        const auto [target, source] = pairs[i];
        found[i] = align_pair(models[source], models[target], settings);
        found[i].source = source;
        found[i].target = target;
        shared.step();
    });
    return found;
}

/// The fits of all candidates, in their order: those tried before as they are, the others now.
std::vector<PairFit> fits_of(const Beginning& begun, std::span<const PairFit> tried,
                             SharedProgress& shared) {
    std::map<ScanPair, const PairFit*> known;
    for (const PairFit& fit : tried)
        known[{fit.target, fit.source}] = &fit;
    std::vector<ScanPair> left;
    std::ranges::copy_if(begun.candidates, std::back_inserter(left),
                         [&](const ScanPair& pair) { return !known.contains(pair); });
    shared.grow(left.size());
    const std::vector<PairFit> found = align_pairs(begun.models, left, begun.pair_settings, shared);
    for (const PairFit& fit : found)
        known[{fit.target, fit.source}] = &fit;
    std::vector<PairFit> all;
    for (const ScanPair& pair : begun.candidates)
        all.push_back(*known.at(pair));
    return all;
}

}  // namespace

PairPlan plan_pairs(std::span<const Scan> scans, const RegistrationSettings& settings,
                    const Progress& progress) {
    SharedProgress shared(progress, scans.size());
    const Beginning begun = begin(scans, settings, shared);
    return {begun.pair_settings.voxel_size, begun.all_seen, begun.candidates};
}

std::vector<PairFit> try_pairs(std::span<const Scan> scans, const RegistrationSettings& settings,
                               const PairPlan& plan, std::span<const ScanPair> pairs,
                               const Progress& progress) {
    SharedProgress shared(progress, pairs.size());
    std::vector<ScanModel> models(scans.size());
    tbb::parallel_for(std::size_t{0}, scans.size(), [&](std::size_t i) {
        const bool named = std::ranges::any_of(
            pairs, [&](const ScanPair& pair) { return pair.first == i || pair.second == i; });
        if (!named) return;
        models[i] = model_scan(scans[i], plan.voxel_size, settings.upright, plan.all_seen);
        models[i].keypoints = describe(models[i].wide);
    });
    return align_pairs(models, pairs, {.voxel_size = plan.voxel_size, .upright = settings.upright},
                       shared);
}

Registration align_scans(std::span<const Scan> scans, const RegistrationSettings& settings,
                         const Progress& progress, std::span<const PairFit> tried) {
    // Steps 1 and 2: what the scans look like, what is known of how they lie.
    SharedProgress shared(progress, scans.size());
    Beginning begun = begin(scans, settings, shared);
    const PairSettings& pair_settings = begun.pair_settings;
    const std::vector<ScanModel>& models = begun.models;
    std::vector<PairFit>& pairs = begun.pairs;
    Assembly& assembly = begun.assembly;
    Registration result;
    result.voxel_size = pair_settings.voxel_size;
    result.pairs_tried = pairs.size() + begun.candidates.size();
    const std::vector<PairFit> found = fits_of(begun, tried, shared);
    pairs.insert(pairs.end(), found.begin(), found.end());

    // 3. Together: join, close loops, let the pose graph settle.
    assemble(models, pairs, pair_settings, assembly);
    settle(pairs, pair_settings, begun.frame.fixed, assembly);
    for (int round = 0; round < kLoopRounds; ++round) {
        const std::vector<PairFit> loops = close_loops(models, pairs, pair_settings, assembly);
        if (loops.empty()) break;
        pairs.insert(pairs.end(), loops.begin(), loops.end());
        settle(pairs, pair_settings, begun.frame.fixed, assembly);
    }

    // 4. What came of it, in the world's frame.
    write_report(scans, models, pairs, pair_settings, begun.frame, assembly, result);
    return result;
}

}  // namespace glowworm
