#include "preprocess/pipeline/keys.h"

#include "preprocess/pipeline/hash.h"

namespace glowworm {
namespace {

// Every field that decides the result. The bindings hold the functions to the structs: with a field
// more they do not compile.

void add(Hash& hash, const ReadSettings& settings) {
    const auto& [check_crc, columns, delimiter] = settings;
    hash.add(check_crc).add(columns).add(delimiter);
}

void add(Hash& hash, const CleanSettings& settings) {
    const auto& [remove_outliers, outliers, voxel_size] = settings;
    const auto& [neighbours, factor, ray_factor] = outliers;
    hash.add(remove_outliers).add(neighbours).add(factor).add(ray_factor).add(voxel_size);
}

void add(Hash& hash, const RegistrationSettings& settings) {
    const auto& [mode, prior, upright, voxel_size, max_scans, candidates, pairs] = settings;
    hash.add(static_cast<int>(mode)).add(prior ? format_poses(*prior) : std::string());
    hash.add(upright).add(voxel_size).add(max_scans).add(candidates).add(pairs.size());
    for (const auto& [first, second] : pairs)
        hash.add(first).add(second);
}

void add(Hash& hash, const MergeSettings& settings) {
    const auto& [spacing, thin_overlaps, remove_moving, balance_colour] = settings;
    hash.add(spacing).add(thin_overlaps).add(remove_moving).add(balance_colour);
}

void add(Hash& hash, const SurfaceSettings& settings) {
    const auto& [k, max_k, search_radius, noise, slope_error, sharp_edges, albedo, delight,
                 trajectory] = settings;
    hash.add(k).add(max_k).add(search_radius).add(noise).add(slope_error).add(sharp_edges);
    hash.add(albedo).add(delight).add(trajectory.positions.size());
    for (const Vec3d& p : trajectory.positions)
        hash.add(p.x).add(p.y).add(p.z);
    hash.add(trajectory.times.size());
    for (const double time : trajectory.times)
        hash.add(time);
}

/// Grid and tile are not a conversion's; the provenance holds the inputs, which are no setting.
void add(Hash& hash, const BuildSettings& settings) {
    const auto& [depth, voxel_size, samples_per_face, deepest, grid, tile, provenance] = settings;
    static_cast<void>(grid), static_cast<void>(tile), static_cast<void>(provenance);
    hash.add(depth.has_value()).add(depth.value_or(0));
    hash.add(voxel_size.has_value()).add(voxel_size.value_or(0.0));
    hash.add(samples_per_face).add(deepest);
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
