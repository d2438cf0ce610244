// Poses from nothing against known ones: a line per set with time, peak memory and worst errors.
// usage: bench_registration DATA_FOLDER [SET] [random starts]
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "preprocess/clean.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/register/align.h"
#include "preprocess/station.h"

using namespace glowworm;
using Clock = std::chrono::steady_clock;

namespace {

struct Set {
    std::string name, folder;
    std::vector<std::string> files;
    std::vector<Eigen::Isometry3d> truth;  // T_world_scan
};

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

Eigen::Isometry3d read_matrix(std::istream& in) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    for (int i = 0; i < 16; ++i)
        in >> T.matrix()(i / 4, i % 4);
    return T;
}

/// The sets and their truth; each file's own convention ends here.
std::vector<Set> known_sets(const std::string& data) {
    Set cave{"simulated cave", data + "/scans/D_cavern/", {}, {}};
    for (const ScanPose& pose : read_poses(cave.folder + "poses.json").scans) {
        cave.files.push_back(pose.file);
        cave.truth.push_back(pose.T_world_scan);
    }
    Set site{"terrestrial site", data + "/obs_eq_tls/", {}, {}};
    std::ifstream reference(site.folder + "reference_poses.txt");
    for (std::string line; std::getline(reference, line);) {
        std::istringstream words(line);
        std::string name;
        words >> name;
        if (!name.starts_with("scan")) continue;
        site.files.push_back(name + ".pcd");
        site.truth.push_back(read_matrix(words));
    }
    Set pair{"small_gicp pair", data + "/small_gicp/", {"target.ply", "source.ply"}, {}};
    std::ifstream relative(pair.folder + "T_target_source.txt");
    pair.truth = {Eigen::Isometry3d::Identity(), read_matrix(relative)};
    Set bunny{"bunny", data + "/stanford_bunny/", {}, {}};
    std::ifstream configuration(bunny.folder + "bun.conf");
    for (std::string line; std::getline(configuration, line);) {
        std::istringstream words(line);
        std::string kind, file;
        Eigen::Vector3d t;
        Eigen::Vector4d q;  // x y z w; p_world = R(q)ᵀ p + t
        words >> kind >> file >> t.x() >> t.y() >> t.z() >> q[0] >> q[1] >> q[2] >> q[3];
        if (kind != "bmesh" || !std::filesystem::exists(bunny.folder + file)) continue;
        bunny.files.push_back(file);
        bunny.truth.push_back(Eigen::Translation3d(t) *
                              Eigen::Quaterniond(q).normalized().conjugate());
    }
    return {cave, site, pair, bunny};
}

void turn_at_random(Scan& scan, Eigen::Isometry3d& truth, std::mt19937& rng) {
    std::normal_distribution<double> normal;
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng)).normalized();
    for (Vec3f& p : scan.points.positions) {
        const Eigen::Vector3d turned = q * Eigen::Vector3d(p.x, p.y, p.z);
        p = vec3_cast<float>(Vec3d{turned.x(), turned.y(), turned.z()});
    }
    truth = truth * q.conjugate();
}

void run(const Set& set, unsigned seed) {
    std::vector<Scan> scans;
    std::vector<Eigen::Isometry3d> truth = set.truth;
    std::mt19937 rng(seed);
    for (std::size_t i = 0; i < set.files.size(); ++i) {
        scans.push_back(read_scans(set.folder + set.files[i]).at(0));
        if (seed != 0) turn_at_random(scans[i], truth[i], rng);
    }
    const Clock::time_point start = Clock::now();
    for (Scan& scan : scans) {
        scan.has_viewpoint = origin_is_viewpoint(scan.points);
        scan.points = clean(scan.points, scan.has_viewpoint, {});
    }
    const double cleaned = seconds_since(start);
    const Registration result = align_scans(scans, {.mode = PriorMode::kIgnore});
    const double total = seconds_since(start);

    double degrees = 0.0, millimetres = 0.0;
    const std::vector<ScanPose>& poses = result.poses.scans;
    for (std::size_t i = 0; i < scans.size(); ++i) {
        if (poses[i].status == PoseStatus::kUnregistered) continue;
        const Eigen::Isometry3d E = (truth[0].inverse() * truth[i]).inverse() *
                                    poses[0].T_world_scan.inverse() * poses[i].T_world_scan;
        degrees = std::max(degrees, Eigen::AngleAxisd(E.rotation()).angle() * 57.29577951308232);
        millimetres = std::max(millimetres, 1000.0 * E.translation().norm());
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("| {} | {} | {}/{} | {:.4f} | {:.2f} | {:.2f} | {:.2f} | {} |\n", set.name,
               seed == 0 ? "as they are" : fmt::format("random {}", seed),
               scans.size() - result.unregistered, scans.size(), degrees, millimetres, cleaned,
               total, usage.ru_maxrss / 1024);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: bench_registration DATA_FOLDER [SET] [random starts]\n");
        return 2;
    }
    const unsigned starts = argc > 3 ? static_cast<unsigned>(std::stoul(argv[3])) : 0;
    fmt::print(
        "| set | start | placed | worst deg | worst mm | clean s | clean + register s | peak MB "
        "|\n");
    fmt::print("|---|---|---|---|---|---|---|---|\n");
    for (const Set& set : known_sets(argv[1])) {
        if (argc > 2 && set.name.find(argv[2]) == std::string::npos) continue;
        for (unsigned seed = 0; seed <= starts; ++seed)
            run(set, seed);
    }
    return 0;
}
