// What must not be believed: pairs of the cavern with little in common, mirrored scans, scans of
// different sites with and without known stations, passages that repeat themselves. One false
// acceptance is one too many.
// usage: bench_refusals DATA_FOLDER [first seed of the simulated caves 1]
#include <fmt/format.h>

#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include "preprocess/clean.h"
#include "preprocess/read/read_scans.h"
#include "preprocess/register/align.h"
#include "preprocess/register/features.h"
#include "preprocess/register/pairwise.h"
#include "preprocess/station.h"
#include "tests/register/simulated_chain.h"

using namespace glowworm;

namespace {

std::vector<Scan> load(const std::string& folder, const std::vector<std::string>& names) {
    std::vector<Scan> scans;
    for (const std::string& name : names) {
        scans.push_back(read_scans(folder + name).at(0));
        scans.back().has_viewpoint = origin_is_viewpoint(scans.back().points);
        scans.back().points = clean(scans.back().points, scans.back().has_viewpoint, {});
    }
    return scans;
}

std::vector<ScanModel> describe_all(std::span<const Scan> scans, double voxel_size) {
    std::vector<ScanModel> models;
    for (const Scan& scan : scans) {
        models.push_back(model_scan(scan, voxel_size, false));
        models.back().keypoints = describe(models.back().wide);
    }
    return models;
}

Eigen::Isometry3d of_scans(const PairFit& pair, const ScanModel& source, const ScanModel& target) {
    return Eigen::Isometry3d(Eigen::Quaterniond(target.R_model_scan)).inverse() *
           pair.fit.T_target_source * Eigen::Isometry3d(Eigen::Quaterniond(source.R_model_scan));
}

/// A line of the table: `accepted` of `pairs`, and how near a wrong one came to being believed.
class Row {
  public:
    explicit Row(std::string name) : name_(std::move(name)) {}
    ~Row() {
        const double seconds = static_cast<double>(std::clock() - start_) / CLOCKS_PER_SEC;
        fmt::print("| {} | {} | {} | {} | {:.3f} | {:.3f} |\n", name_, pairs_, right_, false_,
                   nearest_, pairs_ == 0 ? 0.0 : seconds / static_cast<double>(pairs_));
        std::fflush(stdout);
    }
    void add(const PairFit& pair, bool is_right) {
        ++pairs_;
        if (pair.believed) ++(is_right ? right_ : false_);
        if (!is_right && pair.fit.inliers >= 200 && pair.agreement.best_overlap() >= 0.08)
            nearest_ = std::min(nearest_, pair.agreement.contradicted());
    }
    void add(bool accepted) {
        ++pairs_;
        false_ += accepted ? 1 : 0;
    }

  private:
    std::string name_;
    std::size_t pairs_ = 0, right_ = 0, false_ = 0;
    double nearest_ = 1.0;
    std::clock_t start_ = std::clock();
};

void all_against_all(Row& row, std::span<const ScanModel> targets,
                     std::span<const ScanModel> sources, double voxel_size) {
    for (const ScanModel& target : targets) {
        for (const ScanModel& source : sources)
            row.add(align_pair(source, target, {.voxel_size = voxel_size}), false);
    }
}

void forget_stations(std::vector<Scan>& scans) {
    for (Scan& scan : scans)
        scan.has_viewpoint = false;
}

/// Two scans of a passage that is the same every `period` metres.
bool accepts_a_period(double period, double apart) {
    testing::SimulatedCave cave;
    for (int i = -60; i <= 60; ++i) {
        for (int k = 0; k < 3; ++k) {
            cave.air.push_back(
                {{i * period + 0.3 * k, 0.25 * std::sin(2.1 * k), 0.2 * std::cos(1.7 * k)},
                 0.9 + 0.1 * k * period});
        }
        for (double x = 0.0; x < period; x += 0.4)
            cave.air.push_back({{i * period + x, 0, 0}, 0.8});
    }
    std::vector<Scan> scans;
    std::vector<Eigen::Isometry3d> truth;
    for (unsigned s = 0; s < 2; ++s) {
        truth.push_back(testing::station_at({0.2 + apart * s, 0, 0}, s + 1));
        scans.push_back(testing::scan_cave(cave, truth.back(), 40000, s + 1));
        std::erase_if(scans.back().points.positions,
                      [](const Vec3f& p) { return length(p) > 9.0f; });
    }
    const Registration result = align_scans(scans, {});
    const auto& poses = result.poses.scans;
    const testing::PoseError e = testing::pose_error(
        poses[0].T_world_scan.inverse() * poses[1].T_world_scan, truth[0].inverse() * truth[1]);
    return result.trustworthy() && e.millimetres > 50.0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        fmt::print(stderr, "usage: bench_refusals DATA_FOLDER [first seed]\n");
        return 2;
    }
    const std::string data = std::string(argv[1]) + "/";
    const unsigned seed = argc > 2 ? static_cast<unsigned>(std::stoul(argv[2])) : 1;
    fmt::print(
        "| pairs of | pairs | right ones believed | false ones believed | least seen "
        "through of a wrong one | processor s a pair |\n|---|---|---|---|---|---|\n");

    std::vector<std::string> names;
    std::vector<Eigen::Isometry3d> truth;
    for (const ScanPose& pose : read_poses(data + "scans/D_cavern/poses.json").scans) {
        names.push_back(pose.file);
        truth.push_back(pose.T_world_scan);
    }
    std::vector<Scan> cave = load(data + "scans/D_cavern/", names);
    const double v = choose_voxel_size(cave, false);
    const std::vector<ScanModel> models = describe_all(cave, v);
    {
        Row row("the cavern, all");
        for (std::size_t a = 0; a < models.size(); ++a) {
            for (std::size_t b = a + 1; b < models.size(); ++b) {
                const PairFit pair = align_pair(models[b], models[a], {.voxel_size = v});
                const testing::PoseError e = testing::pose_error(
                    of_scans(pair, models[b], models[a]), truth[a].inverse() * truth[b]);
                row.add(pair, e.millimetres < 50.0 && e.degrees < 0.5);
            }
        }
    }
    std::vector<Scan> mirrored = cave;
    for (Scan& scan : mirrored) {
        for (Vec3f& p : scan.points.positions)
            p.x = -p.x;
    }
    {
        Row row("the cavern and its mirror image");
        all_against_all(row, models, describe_all(mirrored, v), v);
    }
    const std::vector<std::string> four{"scan000.pcd", "scan001.pcd", "scan002.pcd", "scan003.pcd"};
    std::vector<Scan> site = load(data + "obs_eq_tls/", four);
    for (Scan& scan : site) {
        for (Vec3f& p : scan.points.positions)
            p = p * 0.25f;  // of the cavern's size
    }
    {
        Row row("the cavern and the terrestrial site");
        all_against_all(row, models, describe_all(site, v), v);
    }
    const testing::Chain one = testing::chain_of_stations({.stations = 10}, seed),
                         other = testing::chain_of_stations({.stations = 10}, seed + 1);
    const double u = choose_voxel_size(one.scans, false);
    {
        Row row("two sparse simulated passages");
        all_against_all(row, describe_all(one.scans, u), describe_all(other.scans, u), u);
    }
    {
        std::vector<Scan> flipped = one.scans;
        for (Scan& scan : flipped) {
            for (Vec3f& p : scan.points.positions)
                p.y = -p.y;
        }
        Row row("a sparse simulated passage and its mirror image");
        all_against_all(row, describe_all(one.scans, u), describe_all(flipped, u), u);
    }
    forget_stations(cave);
    forget_stations(mirrored);
    forget_stations(site);
    const std::vector<ScanModel> blind = describe_all(cave, v);
    {
        Row row("stations unknown: the cavern and its mirror image");
        all_against_all(row, blind, describe_all(mirrored, v), v);
    }
    {
        Row row("stations unknown: the cavern and the terrestrial site");
        all_against_all(row, blind, describe_all(site, v), v);
    }
    {
        Row row("passages that repeat themselves");
        for (const double period : {0.8, 1.5, 2.5}) {
            for (const double apart : {1.0, 3.2, 6.1})
                row.add(accepts_a_period(period, apart));
        }
    }
    return 0;
}
