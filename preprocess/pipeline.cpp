#include "preprocess/pipeline.h"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "octree/area_lights.h"
#include "octree/checksums.h"
#include "octree/error.h"
#include "octree/octree_writer.h"
#include "preprocess/pipeline/checkpoint.h"
#include "preprocess/pipeline/ingest.h"
#include "preprocess/pipeline/keys.h"
#include "preprocess/pipeline/shares.h"
#include "preprocess/register/pairwise.h"

namespace glowworm {
namespace {

/// Throws unless every scan was placed and is held, or the user goes on without those that were
/// not placed.
void require_trust(const Registration& registration, bool allow_missing_scans) {
    if (registration.trustworthy()) return;
    const bool any_left = registration.unregistered < registration.poses.scans.size();
    if (registration.loose.empty() && allow_missing_scans && any_left) return;
    throw Error(ExitCode::kNotTrustworthy,
                fmt::format("{}; {}", distrust(registration),
                            !registration.loose.empty()
                                ? "register the scans, look at their poses and go on with "
                                  "--poses FILE --poses trust"
                            : any_left ? "--allow-missing-scans goes on without them"
                                       : "check that the scans overlap, or give --poses"));
}

/// Throws where the deepest tree of such voxels is smaller than one of the scans alone.
void require_reachable(const BuildSettings& settings, std::span<const ScanFacts> facts) {
    if (!settings.voxel_size) return;
    const double largest_cube = std::ldexp(*settings.voxel_size, static_cast<int>(kMaxDepth));
    for (const ScanFacts& scan : facts) {
        const Vec3d size = scan.high - scan.low;
        const double extent = std::max({size.x, size.y, size.z});
        if (extent <= largest_cube) continue;
        throw Error(ExitCode::kUsage,
                    fmt::format("voxels of {} m cannot span the {:.1f} m of '{}' in {} levels; "
                                "choose larger ones",
                                *settings.voxel_size, extent, scan.counts.name, kMaxDepth));
    }
}

/// All scans one after the other, and in `conversion` what was found in them.
std::vector<Scan> gather(std::vector<Ingested> ingested, const BuildSettings& build,
                         Conversion& conversion) {
    std::vector<Scan> scans;
    std::vector<ScanFacts> facts;
    for (Ingested& file : ingested) {
        std::ranges::move(file.scans, std::back_inserter(scans));
        std::ranges::move(file.facts, std::back_inserter(facts));
        conversion.points += file.points;
        conversion.outliers += file.outliers;
    }
    conversion.scans = scans.size();
    conversion.warnings = preflight(facts);
    require_reachable(build, facts);
    return scans;
}

/// Whether the octree an earlier run kept is there and whole.
bool is_sound(const std::filesystem::path& path) {
    try {
        const OctreeFile file = OctreeFile::open(path);
        return check_checksums(file).empty();
    } catch (const Error&) {
        return false;
    }
}

/// At the end of its scope what was freed goes back to the system, which else counts it as used.
struct GiveBackMemory {
    ~GiveBackMemory() { ::malloc_trim(0); }
};

/// Each stage takes what it kept, else makes it of what the stage before has, and keeps it.
class Stages {
  public:
    Stages(std::span<const ScanInput> inputs, const ConvertSettings& settings, const Phases& begin,
           const std::function<void(const Registration&)>& registered, const WorkFolder& work)
        : inputs_(inputs),
          settings_(settings),
          begin_(begin),
          registered_(registered),
          work_(work),
          keys_(stage_keys(inputs, settings)) {}

    std::vector<Scan> scans() {
        std::vector<std::filesystem::path> files;
        for (const ScanInput& input : inputs_)
            files.push_back(input.path);
        done = {};
        return gather(ingest_all(files, {settings_.read, settings_.clean}, begin_("read", "files"),
                                 &work_, keys_.ingest),
                      settings_.build, done);
    }

    void register_scans(std::span<const Scan> scans) {
        Conversion kept;
        if (load_report(work_, "registration", keys_.registration, kept)) {
            done.registration = std::move(kept.registration);
        } else {
            done.registration =
                align_scans(scans, settings_.registration, begin_("register", "pairs"),
                            tried_pairs(work_, keys_.registration));
            save_report(work_, "registration", keys_.registration, done);
        }
        registered_(done.registration);
        require_trust(done.registration, settings_.allow_missing_scans);
    }

    PointCloud cloud() {
        const GiveBackMemory afterwards;
        PointCloud cloud;
        if (load_cloud(work_, keys_.cloud, done, cloud)) {
            registered_(done.registration);
            return cloud;
        }
        const std::vector<Scan> clean_scans = scans();
        register_scans(clean_scans);
        cloud = merge_scans(clean_scans, done.registration.poses, settings_.merge,
                            begin_("merge", "points"), &done.merge);
        save_cloud(work_, keys_.cloud, done, cloud);
        return cloud;
    }

    SurfelCloud surfels() {
        const GiveBackMemory afterwards;
        SurfelCloud surfels;
        if (load_surfels(work_, keys_.surfels, done, surfels)) {
            registered_(done.registration);
            return surfels;
        }
        const PointCloud points = cloud();
        surfels =
            make_surfels(points, settings_.surface, &done.surface, begin_("surface", "points"));
        save_surfels(work_, keys_.surfels, done, surfels);
        return surfels;
    }

    void octree() {
        const GiveBackMemory afterwards;
        const std::filesystem::path file = octree_part(work_);
        if (load_report(work_, "built", keys_.octree, done) && is_sound(file)) {
            registered_(done.registration);
            return;
        }
        // In between there is an octree that nothing vouches for.
        std::filesystem::remove(work_.part("built"));
        if (join_tiles(work_, keys_.octree, settings_.build.provenance, file, begin_, done)) {
            registered_(done.registration);
        } else {
            build(file);
        }
        save_report(work_, "built", keys_.octree, done);
    }

    Conversion done;

  private:
    void build(const std::filesystem::path& file) {
        SurfelCloud cloud = surfels();
        add_area_lights(cloud, settings_.area_lights);
        const Progress building = begin_("build", "surfels");
        const Octree octree = build_octree(std::move(cloud), settings_.build, building);
        // Not synced: where a power cut damages it, is_sound says so.
        write_octree_file(octree.view(), file,
                          {.progress = all_done(building, octree.sample_count), .synced = false});
    }

    std::span<const ScanInput> inputs_;
    const ConvertSettings& settings_;
    const Phases& begin_;
    const std::function<void(const Registration&)>& registered_;
    const WorkFolder& work_;
    StageKeys keys_;
};

}  // namespace

std::vector<Scan> read_clean_scans(std::span<const std::filesystem::path> files,
                                   const ConvertSettings& settings, const Phases& begin,
                                   Conversion& conversion) {
    return gather(ingest_all(files, {settings.read, settings.clean}, begin("read", "files")),
                  settings.build, conversion);
}

std::filesystem::path octree_part(const WorkFolder& work) {
    return work.part("octree");
}

bool load_registration(const WorkFolder& work, Conversion& kept) {
    return load_report(work, "registration", {}, kept);
}

std::string kept_poses(const WorkFolder& work) {
    Conversion kept;
    return load_registration(work, kept) ? format_poses(kept.registration.poses) : "";
}

Conversion convert_scans(std::span<const ScanInput> inputs, const ConvertSettings& settings,
                         const Phases& begin,
                         const std::function<void(const Registration&)>& registered,
                         const WorkFolder& work, Stage until) {
    Stages stages(inputs, settings, begin, registered, work);
    switch (until) {
        case Stage::kIngest:
            stages.scans();
            break;
        case Stage::kRegister:
            stages.register_scans(stages.scans());
            break;
        case Stage::kMerge:
            stages.cloud();
            break;
        case Stage::kSurface:
            stages.surfels();
            break;
        case Stage::kBuild:
            stages.octree();
            break;
    }
    return std::move(stages.done);
}

}  // namespace glowworm
