#include "preprocess/pipeline/checkpoint.h"

#include <concepts>

#include "preprocess/pipeline/archive.h"

namespace glowworm {

// One function a struct names its fields, for writing (const) and for reading.
template <typename T, typename Struct>
concept Is = std::same_as<std::remove_const_t<T>, Struct>;

template <typename A, Is<std::string> T>
void archive(A& file, T& text) {
    file(text);
}

template <typename A, Is<Points> T>
void archive(A& file, T& points) {
    file(points.positions);
    file(points.normals);
    file(points.colours);
    file(points.intensities);
    file(points.ndf_lengths);
    file(points.radii);
    file(points.stations);
    file(points.emissions);
    file(points.times);
}

template <typename A, Is<Scan> T>
void archive(A& file, T& scan) {
    file(scan.name);
    file(scan.offset);
    archive(file, scan.points);
    file(scan.T_world_scan);
    file(scan.has_viewpoint);
}

template <typename A, Is<ScanFacts> T>
void archive(A& file, T& facts) {
    file(facts.counts.name);
    file(facts.counts.declared);
    file(facts.counts.kept);
    file(facts.counts.not_finite);
    file(facts.counts.no_return);
    file(facts.counts.invalid);
    file(facts.low);
    file(facts.high);
    file(facts.has_colours);
    file(facts.darkest);
    file(facts.brightest);
    file(facts.duplicate_share);
    file(facts.on_float_grid);
    file(facts.spacing);
    file(facts.has_pose);
    file(facts.crs);
}

template <typename A, Is<Ingested> T>
void archive(A& file, T& ingested) {
    file(ingested.scans);
    file(ingested.facts);
    file(ingested.points);
    file(ingested.outliers);
}

template <typename A, Is<ScanPose> T>
void archive(A& file, T& pose) {
    file(pose.file);
    file(pose.T_world_scan);
    file(pose.status);
    file(pose.rmse);
    file(pose.overlap);
    file(pose.loop_misclosure);
    file(pose.loop_misclosure_deg);
    file(pose.weak_axes);
}

template <typename A, Is<PairPose> T>
void archive(A& file, T& pair) {
    file(pair.source);
    file(pair.target);
    file(pair.T_target_source);
    file(pair.overlap);
    file(pair.contradicted);
    file(pair.rmse);
    file(pair.p95);
    file(pair.inliers);
    file(pair.accepted);
    file(pair.weak_axes);
}

template <typename A, Is<Warning> T>
void archive(A& file, T& warning) {
    file(warning.id);
    file(warning.file);
    file(warning.sentence);
}

template <typename A, Is<Conversion> T>
void archive(A& file, T& done) {
    file(done.warnings);
    file(done.scans);
    file(done.points);
    file(done.outliers);
    file(done.registration.poses.origin);
    file(done.registration.poses.scans);
    file(done.registration.poses.pairs);
    file(done.registration.voxel_size);
    file(done.registration.pairs_tried);
    file(done.registration.unregistered);
    file(done.registration.weak);
    file(done.merge.points_in);
    file(done.merge.moving);
    file(done.merge.thinned);
    file(done.merge.left_out);
    file(done.merge.spacing);
    file(done.surface);
}

template <typename A, Is<Station> T>
void archive(A& file, T& station) {
    file(station.position);
    for (auto& part : station.rotation)
        file(part);
    file(station.has_viewpoint);
    file(station.name);
}

template <typename A, Is<AreaLight> T>
void archive(A& file, T& light) {
    file(light.name);
    for (auto& corner : light.corners)
        file(corner);
    file(light.radiance);
}

template <typename A, Is<PointCloud> T>
void archive(A& file, T& cloud) {
    file(cloud.origin);
    archive(file, cloud.points);
    file(cloud.stations);
    file(cloud.area_lights);
}

template <typename A, Is<SurfelCloud> T>
void archive(A& file, T& cloud) {
    file(cloud.origin);
    file(cloud.surfels);
    file(cloud.stations);
    file(cloud.area_lights);
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
