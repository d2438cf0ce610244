#include "preprocess/pipeline/checkpoint.h"

#include <concepts>

#include "preprocess/pipeline/archive.h"

namespace glowworm {

// One function a struct names its fields, for writing (const) and for reading. The bindings hold
// the functions to the structs: with a field more they do not compile.
template <typename T, typename Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;

template <typename A, Is<std::string> T>
void archive(A& file, T& text) {
    file(text);
}

template <typename A, Is<Points> T>
void archive(A& file, T& all) {
    auto& [positions, normals, colours, intensities, ndf_lengths, radii, stations, emissions, times,
           grid] = all;
    file(positions);
    file(normals);
    file(colours);
    file(intensities);
    file(ndf_lengths);
    file(radii);
    file(stations);
    file(emissions);
    file(times);
    file(grid);
}

template <typename A, Is<Scan> T>
void archive(A& file, T& all) {
    auto& [name, path, offset, points, pose, crs, has_viewpoint] = all;
    file(name);
    static_cast<void>(path);  // whoever loads a scan knows it
    file(offset);
    archive(file, points);
    file(pose);
    file(crs);
    file(has_viewpoint);
}

template <typename A, Is<ScanCounts> T>
void archive(A& file, T& all) {
    auto& [name, declared, kept, not_finite, too_far, no_return, invalid, no_colour, no_intensity] =
        all;
    file(name);
    file(declared);
    file(kept);
    file(not_finite);
    file(too_far);
    file(no_return);
    file(invalid);
    file(no_colour);
    file(no_intensity);
}

template <typename A, Is<ScanFacts> T>
void archive(A& file, T& all) {
    auto& [counts, low, high, has_colours, darkest, brightest, duplicate_share, grid_rows,
           grid_columns, on_float_grid, spacing, has_pose, crs] = all;
    archive(file, counts);
    file(low);
    file(high);
    file(has_colours);
    file(darkest);
    file(brightest);
    file(duplicate_share);
    file(grid_rows);
    file(grid_columns);
    file(on_float_grid);
    file(spacing);
    file(has_pose);
    file(crs);
}

template <typename A, Is<Ingested> T>
void archive(A& file, T& all) {
    auto& [scans, facts, points, outliers] = all;
    file(scans);
    file(facts);
    file(points);
    file(outliers);
}

template <typename A, Is<ScanPose> T>
void archive(A& file, T& all) {
    auto& [name, T_world_scan, status, rmse, overlap, loop_misclosure, loop_misclosure_deg,
           weak_axes] = all;
    file(name);
    file(T_world_scan);
    file(status);
    file(rmse);
    file(overlap);
    file(loop_misclosure);
    file(loop_misclosure_deg);
    file(weak_axes);
}

template <typename A, Is<PairPose> T>
void archive(A& file, T& all) {
    auto& [source, target, T_target_source, overlap, contradicted, rmse, p95, inliers, accepted,
           weak_axes] = all;
    file(source);
    file(target);
    file(T_target_source);
    file(overlap);
    file(contradicted);
    file(rmse);
    file(p95);
    file(inliers);
    file(accepted);
    file(weak_axes);
}

template <typename A, Is<Poses> T>
void archive(A& file, T& all) {
    auto& [origin, scans, pairs] = all;
    file(origin);
    file(scans);
    file(pairs);
}

template <typename A, Is<Warning> T>
void archive(A& file, T& all) {
    auto& [id, name, sentence] = all;
    file(id);
    file(name);
    file(sentence);
}

template <typename A, Is<Registration> T>
void archive(A& file, T& all) {
    auto& [poses, voxel_size, pairs_tried, unregistered, loose] = all;
    archive(file, poses);
    file(voxel_size);
    file(pairs_tried);
    file(unregistered);
    file(loose);
}

template <typename A, Is<MergeReport> T>
void archive(A& file, T& all) {
    auto& [points_in, moving, thinned, left_out, spacing] = all;
    file(points_in);
    file(moving);
    file(thinned);
    file(left_out);
    file(spacing);
}

template <typename A, Is<DelightReport> T>
void archive(A& file, T& all) {
    auto& [applied, distance, incidence, pairs, rms_before, rms_after, reason] = all;
    file(applied);
    file(distance);
    file(incidence);
    file(pairs);
    file(rms_before);
    file(rms_after);
    file(reason);
}

template <typename A, Is<SurfaceReport> T>
void archive(A& file, T& all) {
    auto& [points, surfels, not_finite, duplicates, isolated, grown, edges, weak, unsure_side,
           facing_inside, facing_outside, seen_from_trajectory, orientation, albedo, delighted,
           range_noise, search_radius, median_spacing, mean_ndf_length] = all;
    file(points);
    file(surfels);
    file(not_finite);
    file(duplicates);
    file(isolated);
    file(grown);
    file(edges);
    file(weak);
    file(unsure_side);
    file(facing_inside);
    file(facing_outside);
    file(seen_from_trajectory);
    file(orientation);
    file(albedo);
    archive(file, delighted);
    file(range_noise);
    file(search_radius);
    file(median_spacing);
    file(mean_ndf_length);
}

template <typename A, Is<Conversion> T>
void archive(A& file, T& all) {
    auto& [warnings, scans, points, outliers, registration, merge, surface] = all;
    file(warnings);
    file(scans);
    file(points);
    file(outliers);
    archive(file, registration);
    archive(file, merge);
    archive(file, surface);
}

template <typename A, Is<AreaLight> T>
void archive(A& file, T& all) {
    auto& [name, corners, radiance] = all;
    file(name);
    file(corners);
    file(radiance);
}

template <typename A, Is<Station> T>
void archive(A& file, T& all) {
    auto& [position, rotation, has_viewpoint, name] = all;
    file(position);
    file(rotation);
    file(has_viewpoint);
    file(name);
}

template <typename A, Is<PointCloud> T>
void archive(A& file, T& all) {
    auto& [origin, points, stations, area_lights] = all;
    file(origin);
    archive(file, points);
    file(stations);
    file(area_lights);
}

template <typename A, Is<SurfelCloud> T>
void archive(A& file, T& all) {
    auto& [origin, surfels, stations, area_lights] = all;
    file(origin);
    file(surfels);
    file(stations);
    file(area_lights);
}

namespace {

template <typename... Parts>
void save(const std::filesystem::path& path, const std::string& key, const Parts&... parts) {
    ArchiveWriter file(path, key);
    (archive(file, parts), ...);
    file.commit();
}

template <typename... Parts>
bool load(const std::filesystem::path& path, const std::string& key, Parts&... parts) {
    ArchiveReader file(path, key);
    (archive(file, parts), ...);
    return file.good();
}

std::string scan_part(const std::string& key) {
    return "scan-" + key;
}

}  // namespace

bool load_ingested(const WorkFolder& work, const std::string& key,
                   const std::filesystem::path& path, Ingested& what) {
    if (!load(work.part(scan_part(key)), key, what)) {
        what = {};
        return false;
    }
    for (Scan& scan : what.scans)
        scan.file = path;
    return true;
}

void save_ingested(const WorkFolder& work, const std::string& key, const Ingested& what) {
    save(work.part(scan_part(key)), key, what);
}

bool load_cloud(const WorkFolder& work, const std::string& key, Conversion& so_far,
                PointCloud& what) {
    return load(work.part("cloud"), key, so_far, what);
}

void save_cloud(const WorkFolder& work, const std::string& key, const Conversion& so_far,
                const PointCloud& what) {
    save(work.part("cloud"), key, so_far, what);
}

bool load_surfels(const WorkFolder& work, const std::string& key, Conversion& so_far,
                  SurfelCloud& what) {
    return load(work.part("surfels"), key, so_far, what);
}

void save_surfels(const WorkFolder& work, const std::string& key, const Conversion& so_far,
                  const SurfelCloud& what) {
    save(work.part("surfels"), key, so_far, what);
}

bool load_report(const WorkFolder& work, const std::string& stage, const std::string& key,
                 Conversion& what) {
    return load(work.part(stage), key, what);
}

void save_report(const WorkFolder& work, const std::string& stage, const std::string& key,
                 const Conversion& what) {
    save(work.part(stage), key, what);
}

}  // namespace glowworm
