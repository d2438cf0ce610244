#include "preprocess/pipeline/keys.h"

#include "preprocess/pipeline/hash.h"

namespace glowworm {
namespace {

// Every field that decides the result is named here once; one that is added to a settings struct
// belongs here as well.

void add(Hash& hash, const ReadSettings& s) {
    hash.add(s.check_crc).add(s.columns).add(s.delimiter);
}

void add(Hash& hash, const CleanSettings& s) {
    hash.add(s.remove_outliers).add(s.voxel_size);
    hash.add(s.outliers.neighbours).add(s.outliers.factor).add(s.outliers.ray_factor);
}

void add(Hash& hash, const RegistrationSettings& s) {
    hash.add(static_cast<int>(s.mode)).add(s.prior ? format_poses(*s.prior) : std::string());
    hash.add(s.upright).add(s.voxel_size).add(s.max_scans).add(s.candidates_per_scan);
    hash.add(s.pairs.size());
    for (const auto& [first, second] : s.pairs)
        hash.add(first).add(second);
}

void add(Hash& hash, const MergeSettings& s) {
    hash.add(s.spacing).add(s.thin_overlaps).add(s.remove_moving).add(s.balance_colour);
}

void add(Hash& hash, const SurfaceSettings& s) {
    hash.add(s.k).add(s.max_k).add(s.search_radius).add(s.range_noise).add(s.slope_error);
    hash.add(s.sharp_edges).add(s.default_albedo);
}

void add(Hash& hash, const BuildSettings& s) {
    hash.add(s.depth.has_value()).add(s.depth.value_or(0));
    hash.add(s.voxel_size.has_value()).add(s.voxel_size.value_or(0.0));
    hash.add(s.samples_per_face).add(s.deepest_automatic);
}

void add(Hash& hash, const std::vector<AreaLight>& lights) {
    hash.add(lights.size());
    for (const AreaLight& light : lights) {
        hash.add(light.name);
        for (const Vec3d& corner : light.corners)
            hash.add(corner.x).add(corner.y).add(corner.z);
        hash.add(light.radiance.x).add(light.radiance.y).add(light.radiance.z);
    }
}

/// A program that was compiled anew may come to another result.
const std::string& this_program() {
    static const std::string hash = describe_input("/proc/self/exe").hash;
    return hash;
}

}  // namespace

std::string settings_hash(const ConvertSettings& settings) {
    Hash hash;
    add(hash, settings.read);
    add(hash, settings.clean);
    add(hash, settings.registration);
    add(hash, settings.merge);
    add(hash, settings.surface);
    add(hash, settings.build);
    add(hash, settings.area_lights);
    hash.add(settings.allow_missing_scans).add(settings.links);
    return hash.hex();
}

std::string ingest_key(const ScanInput& input, const ConvertSettings& settings) {
    Hash hash;
    hash.add("ingest").add(this_program()).add(input.content.file).add(input.content.hash);
    add(hash, settings.read);
    add(hash, settings.clean);
    return hash.hex();
}

StageKeys stage_keys(std::span<const ScanInput> inputs, const ConvertSettings& settings) {
    StageKeys keys;
    Hash registration;
    registration.add("register");
    add(registration, settings.registration);
    for (const ScanInput& input : inputs) {
        keys.ingest.push_back(ingest_key(input, settings));
        registration.add(keys.ingest.back()).add(input.path.string());
    }
    keys.registration = registration.hex();

    Hash cloud;
    cloud.add("merge").add(keys.registration).add(settings.allow_missing_scans);
    add(cloud, settings.merge);
    keys.cloud = cloud.hex();

    Hash surfels;
    surfels.add("surface").add(keys.cloud);
    add(surfels, settings.surface);
    keys.surfels = surfels.hex();

    Hash octree;
    octree.add("build").add(keys.surfels).add(settings.build.provenance);
    add(octree, settings.build);
    add(octree, settings.area_lights);
    keys.octree = octree.hex();
    return keys;
}

}  // namespace glowworm
