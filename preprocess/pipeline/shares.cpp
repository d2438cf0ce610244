#include "preprocess/pipeline/shares.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "octree/area_lights.h"
#include "octree/build.h"
#include "octree/error.h"
#include "octree/join.h"
#include "octree/octree.h"
#include "octree/octree_writer.h"
#include "octree/tiling.h"
#include "preprocess/pipeline/checkpoint.h"
#include "preprocess/pipeline/keys.h"
#include "preprocess/pipeline/work_folder.h"
#include "preprocess/register/pairwise.h"

namespace glowworm {
namespace {

/// All scans of the inputs, as ingest keeps them.
std::vector<Scan> ingested_scans(std::span<const ScanInput> inputs, const StageKeys& keys,
                                 const ConvertSettings& settings, const Phases& begin,
                                 const WorkFolder& work) {
    std::vector<std::filesystem::path> files;
    for (const ScanInput& input : inputs)
        files.push_back(input.path);
    std::vector<Scan> scans;
    for (Ingested& file : ingest_all(files, {settings.read, settings.clean}, begin("read", "files"),
                                     &work, keys.ingest))
        std::ranges::move(file.scans, std::back_inserter(scans));
    return scans;
}

/// The same with points in those scans only that one of the pairs names.
std::vector<Scan> scans_of_pairs(std::span<const ScanInput> inputs, const StageKeys& keys,
                                 const ConvertSettings& settings,
                                 std::span<const std::pair<std::size_t, std::size_t>> pairs,
                                 const Progress& progress, const WorkFolder& work) {
    std::vector<Scan> scans;
    for (std::size_t i = 0; i < inputs.size(); ++i) {
        if (progress) progress(i, inputs.size());
        Ingested file;
        if (!load_ingested(work, keys.ingest[i], inputs[i].path, file)) {
            file = ingest(inputs[i].path, {settings.read, settings.clean});
            save_ingested(work, keys.ingest[i], file);
        }
        for (Scan& scan : file.scans) {
            const bool named = std::ranges::any_of(pairs, [&](const auto& pair) {
                return pair.first == scans.size() || pair.second == scans.size();
            });
            if (!named) scan.points = {};
            scans.push_back(std::move(scan));
        }
    }
    return scans;
}

/// Where share number `part` of `parts` of `count` things begins.
std::size_t share_begin(std::size_t count, std::size_t part, std::size_t parts) {
    return count * part / parts;
}

/// All shares of a stage that are kept, whatever the number of jobs.
std::vector<Share> kept_shares(const WorkFolder& work, const std::string& stage) {
    std::vector<Share> shares;
    for (const std::string& name : work.parts()) {
        const std::size_t of = name.find("of");
        if (!name.starts_with(stage + "-") || of == std::string::npos) continue;
        std::string text = name.substr(stage.size() + 1);
        text.replace(text.find("of"), 2, "/");
        shares.push_back(parse_share(text));
    }
    return shares;
}

/// Cells of the grid that cover all of it, about as many as `parts`.
Tiling cut_into(std::uint32_t parts, const SurfelCloud& cloud, const Grid& grid) {
    CellWeights weights(grid, {});
    for (const Surfel& surfel : cloud.surfels)
        weights.add(surfel);
    const std::uint64_t heaviest = *std::ranges::max_element(weights.weights());
    return Tiling(weights, std::max(weights.total() / parts, heaviest), 0);
}

}  // namespace

std::string Share::name(const std::string& stage) const {
    return fmt::format("{}-{}of{}", stage, part, parts);
}

Share parse_share(const std::string& text) {
    Share share;
    const char* end = text.data() + text.size();
    const auto part = std::from_chars(text.data(), end, share.part);
    const bool slash = part.ec == std::errc() && part.ptr != end && *part.ptr == '/';
    const auto parts = slash ? std::from_chars(part.ptr + 1, end, share.parts) : part;
    if (slash && parts.ec == std::errc() && parts.ptr == end && share.part >= 1 &&
        share.part <= share.parts && share.parts <= 9999)
        return share;
    throw Error(ExitCode::kUsage,
                fmt::format("'{}' is no part of a stage; write the second of eight as 2/8", text));
}

std::size_t plan_share_of_pairs(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                                const Phases& begin, const WorkFolder& work) {
    const StageKeys keys = stage_keys(inputs, settings);
    PairPlan plan;
    if (load_pair_plan(work, keys.registration, plan)) return plan.pairs.size();
    const std::vector<Scan> scans = ingested_scans(inputs, keys, settings, begin, work);
    plan = plan_pairs(scans, settings.registration, begin("plan", "scans"));
    save_pair_plan(work, keys.registration, plan);
    return plan.pairs.size();
}

std::size_t try_share_of_pairs(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                               const Phases& begin, const WorkFolder& work, const Share& share) {
    const StageKeys keys = stage_keys(inputs, settings);
    std::vector<PairFit> fits;
    if (load_share(work, keys.registration, share, fits)) return fits.size();
    PairPlan plan;
    if (!load_pair_plan(work, keys.registration, plan)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' does not say which pairs there are to try; run `glowworm "
                                "pairs` without --part first",
                                work.path().string()));
    }
    const std::size_t first = share_begin(plan.pairs.size(), share.part - 1, share.parts);
    const std::size_t end = share_begin(plan.pairs.size(), share.part, share.parts);
    const auto pairs = std::span(plan.pairs).subspan(first, end - first);
    const std::vector<Scan> scans =
        scans_of_pairs(inputs, keys, settings, pairs, begin("read", "files"), work);
    fits = try_pairs(scans, settings.registration, plan, pairs, begin("register", "pairs"));
    save_share(work, keys.registration, share, fits);
    return fits.size();
}

std::vector<PairFit> tried_pairs(const WorkFolder& work, const std::string& key) {
    std::vector<PairFit> all, fits;
    for (const Share& share : kept_shares(work, "pairs")) {
        if (load_share(work, key, share, fits)) all.insert(all.end(), fits.begin(), fits.end());
    }
    return all;
}

std::size_t build_share_of_tiles(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                                 const Phases& begin, const WorkFolder& work, const Share& share) {
    const StageKeys keys = stage_keys(inputs, settings);
    Conversion so_far;
    TileShare kept;
    if (load_share(work, keys.octree, share, so_far, kept)) return kept.names.size();
    SurfelCloud cloud;
    if (!load_surfels(work, keys.surfels, so_far, cloud)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' has no surfels of these scans and settings; run `glowworm "
                                "convert --until surface` first",
                                work.path().string()));
    }

    // 1. Usable surfels, the grid and its tiles: the same in every job.
    add_area_lights(cloud, settings.area_lights);
    const CloudSummary summary = summarize(cloud.surfels);
    BuildSettings tile = settings.build;
    tile.grid = fit_grid(summary, cloud.origin, settings.build);
    std::erase_if(cloud.surfels, [](const Surfel& surfel) { return !is_usable(surfel); });
    for (Surfel& surfel : cloud.surfels)
        if (summary.needs_repair) repair(surfel, summary.median_radius);
    const Tiling tiling = cut_into(share.parts, cloud, *tile.grid);

    // 2. To each tile of the share what reaches into it.
    const std::size_t count = tiling.tiles().size();
    const std::size_t first = share_begin(count, share.part - 1, share.parts);
    const std::size_t end = share_begin(count, share.part, share.parts);
    std::vector<SurfelCloud> own(end - first,
                                 {cloud.origin, {}, cloud.stations, cloud.area_lights});
    std::vector<std::uint32_t> reached;
    for (const Surfel& surfel : cloud.surfels) {
        tiling.find(surfel, reached);
        for (const std::uint32_t t : reached)
            if (t >= first && t < end) own[t - first].surfels.push_back(surfel);
    }
    cloud = {};

    // 3. Each by itself.
    const Progress progress = begin("build", "tiles");
    TileShare built{.dropped = summary.dropped, .names = {}};
    for (std::size_t t = first; t < end; ++t) {
        progress(t - first, end - first);
        if (own[t - first].surfels.empty()) continue;
        tile.tile = tiling.tiles()[t];
        const Octree octree = build_octree(std::move(own[t - first]), tile);
        built.names.push_back(fmt::format("{}-{}", share.name("tile"), t - first));
        write_octree_file(octree.view(), work.part(built.names.back()));
    }
    save_share(work, keys.octree, share, so_far, built);
    return built.names.size();
}

bool join_tiles(const WorkFolder& work, const std::string& key, const std::string& provenance,
                const std::filesystem::path& output, const Phases& begin, Conversion& so_far) {
    for (const Share& any : kept_shares(work, "tiles")) {
        if (any.part != 1) continue;
        std::vector<OctreeFile> tiles;
        TileShare share;
        bool complete = true;
        for (std::uint32_t part = 1; part <= any.parts && complete; ++part) {
            complete = load_share(work, key, {part, any.parts}, so_far, share);
            if (!complete) break;
            for (const std::string& name : share.names)
                tiles.push_back(OctreeFile::open(work.part(name)));
        }
        if (!complete || tiles.empty()) continue;
        join_octrees(tiles, {provenance, share.dropped, begin("join", "bytes")}, output);
        return true;
    }
    return false;
}

}  // namespace glowworm
