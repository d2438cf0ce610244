#include "preprocess/pipeline/checkpoint.h"

#include <algorithm>
#include <array>
#include <concepts>
#include <utility>

#include "preprocess/pipeline/archive.h"
#include "preprocess/register/pairwise.h"

namespace glowworm {

// One function a struct names its fields, for writing (const) and for reading. The bindings hold
// the functions to the structs: with a field more they do not compile.
template <typename T, typename Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;

template <std::size_t Count, typename A, typename Matrix>
void archive_numbers(A& file, Matrix& matrix) {
    std::array<double, Count> numbers;
    std::copy_n(matrix.data(), Count, numbers.begin());
    file(numbers);
    if constexpr (!std::is_const_v<Matrix>) std::copy_n(numbers.begin(), Count, matrix.data());
}

template <typename A, Is<Eigen::Isometry3d> T>
void archive(A& file, T& pose) {
    archive_numbers<16>(file, pose);
}

template <typename A, Is<Points> T>
void archive(A& file, T& all) {
    auto& [positions, normals, colours, intensities, ndf_lengths, radii, stations, emissions, times,
           grid] = all;
    file(positions, normals, colours, intensities, ndf_lengths, radii, stations, emissions, times,
         grid);
}

template <typename A, Is<Scan> T>
void archive(A& file, T& all) {
    auto& [name, path, offset, points, pose, crs, has_viewpoint] = all;
    file(name);
    static_cast<void>(path);  // whoever loads a scan knows it
    file(offset);
    archive(file, points);
    file(pose, crs, has_viewpoint);
}

template <typename A, Is<ScanCounts> T>
void archive(A& file, T& all) {
    auto& [name, declared, kept, not_finite, too_far, no_return, invalid, no_colour, no_intensity] =
        all;
    file(name, declared, kept, not_finite, too_far, no_return, invalid, no_colour, no_intensity);
}

template <typename A, Is<ScanFacts> T>
void archive(A& file, T& all) {
    auto& [counts, low, high, has_colours, darkest, brightest, duplicate_share, grid_rows,
           grid_columns, on_float_grid, spacing, has_pose, crs] = all;
    archive(file, counts);
    file(low, high, has_colours, darkest, brightest, duplicate_share, grid_rows, grid_columns,
         on_float_grid, spacing, has_pose, crs);
}

template <typename A, Is<Ingested> T>
void archive(A& file, T& all) {
    auto& [scans, facts, points, outliers] = all;
    file(scans, facts, points, outliers);
}

template <typename A, Is<ScanPose> T>
void archive(A& file, T& all) {
    auto& [name, T_world_scan, status, rmse, overlap, loop_misclosure, loop_misclosure_deg,
           weak_axes] = all;
    file(name, T_world_scan, status, rmse, overlap, loop_misclosure, loop_misclosure_deg,
         weak_axes);
}

template <typename A, Is<PairPose> T>
void archive(A& file, T& all) {
    auto& [source, target, T_target_source, overlap, contradicted, rmse, p95, inliers, accepted,
           weak_axes] = all;
    file(source, target, T_target_source, overlap, contradicted, rmse, p95, inliers, accepted,
         weak_axes);
}

template <typename A, Is<Poses> T>
void archive(A& file, T& all) {
    auto& [origin, scans, pairs] = all;
    file(origin, scans, pairs);
}

template <typename A, Is<Warning> T>
void archive(A& file, T& all) {
    auto& [id, name, sentence] = all;
    file(id, name, sentence);
}

template <typename A, Is<Registration> T>
void archive(A& file, T& all) {
    auto& [poses, voxel_size, pairs_tried, unregistered, loose] = all;
    archive(file, poses);
    file(voxel_size, pairs_tried, unregistered, loose);
}

template <typename A, Is<MergeReport> T>
void archive(A& file, T& all) {
    auto& [points_in, moving, thinned, left_out, spacing] = all;
    file(points_in, moving, thinned, left_out, spacing);
}

template <typename A, Is<DelightReport> T>
void archive(A& file, T& all) {
    auto& [applied, distance, incidence, pairs, rms_before, rms_after, reason] = all;
    file(applied, distance, incidence, pairs, rms_before, rms_after, reason);
}

template <typename A, Is<SurfaceReport> T>
void archive(A& file, T& all) {
    auto& [points, surfels, not_finite, duplicates, isolated, grown, edges, weak, unsure_side,
           facing_inside, facing_outside, seen_from_trajectory, orientation, albedo, delighted,
           range_noise, search_radius, median_spacing, mean_ndf_length] = all;
    file(points, surfels, not_finite, duplicates, isolated, grown, edges, weak, unsure_side,
         facing_inside, facing_outside, seen_from_trajectory, orientation, albedo);
    archive(file, delighted);
    file(range_noise, search_radius, median_spacing, mean_ndf_length);
}

template <typename A, Is<Conversion> T>
void archive(A& file, T& all) {
    auto& [warnings, scans, points, outliers, registration, merge, surface] = all;
    file(warnings, scans, points, outliers);
    archive(file, registration);
    archive(file, merge);
    archive(file, surface);
}

template <typename A, Is<AreaLight> T>
void archive(A& file, T& all) {
    auto& [name, corners, radiance] = all;
    file(name, corners, radiance);
}

template <typename A, Is<Station> T>
void archive(A& file, T& all) {
    auto& [position, rotation, has_viewpoint, name] = all;
    file(position, rotation, has_viewpoint, name);
}

template <typename A, Is<PointCloud> T>
void archive(A& file, T& all) {
    auto& [origin, points, stations, area_lights] = all;
    file(origin);
    archive(file, points);
    file(stations, area_lights);
}

template <typename A, Is<SurfelCloud> T>
void archive(A& file, T& all) {
    auto& [origin, surfels, stations, area_lights] = all;
    file(origin, surfels, stations, area_lights);
}

template <typename A, Is<Fit> T>
void archive(A& file, T& all) {
    auto& [T_target_source, converged, inliers, rmse, p95, expected, information, centre, extent] =
        all;
    file(T_target_source, converged, inliers, rmse, p95, expected);
    archive_numbers<36>(file, information);
    archive_numbers<3>(file, centre);
    file(extent);
}

template <typename A, Is<PairFit> T>
void archive(A& file, T& all) {
    auto& [source, target, fit, agreement, matches, ambiguous, believed, accepted] = all;
    file(source, target, fit, agreement, matches, ambiguous, believed, accepted);
}

template <typename A, Is<std::pair<std::size_t, std::size_t>> T>
void archive(A& file, T& pair) {
    file(pair.first, pair.second);
}

template <typename A, Is<PairPlan> T>
void archive(A& file, T& all) {
    auto& [voxel_size, all_seen, pairs] = all;
    file(voxel_size, all_seen, pairs);
}

namespace {

template <typename... Parts>
void save(const std::filesystem::path& path, const std::string& key, const Parts&... parts) {
    ArchiveWriter file(path, key);
    (file(parts), ...);
    file.commit();
}

template <typename... Parts>
bool load(const std::filesystem::path& path, const std::string& key, Parts&... parts) {
    ArchiveReader file(path, key);
    (file(parts), ...);
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

bool load_pair_plan(const WorkFolder& work, const std::string& key, PairPlan& what) {
    return load(work.part("pairs"), key, what);
}

void save_pair_plan(const WorkFolder& work, const std::string& key, const PairPlan& what) {
    save(work.part("pairs"), key, what);
}

bool load_share(const WorkFolder& work, const std::string& key, const Share& share,
                std::vector<PairFit>& what) {
    return load(work.part(share.name("pairs")), key, what);
}

void save_share(const WorkFolder& work, const std::string& key, const Share& share,
                const std::vector<PairFit>& what) {
    save(work.part(share.name("pairs")), key, what);
}

bool load_share(const WorkFolder& work, const std::string& key, const Share& share,
                Conversion& so_far, TileShare& what) {
    return load(work.part(share.name("tiles")), key, so_far, what.dropped, what.names);
}

void save_share(const WorkFolder& work, const std::string& key, const Share& share,
                const Conversion& so_far, const TileShare& what) {
    save(work.part(share.name("tiles")), key, so_far, what.dropped, what.names);
}

}  // namespace glowworm
