#include "preprocess/poses.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "octree/atomic_file.h"
#include "octree/error.h"

namespace glowworm {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kRigidTolerance = 1e-3;
constexpr std::uintmax_t kLargestFile = std::uintmax_t{1} << 30;

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& what) {
    throw Error(ExitCode::kUnreadable,
                fmt::format("{}: {}; give a poses.json with scans[].file and "
                            "scans[].T_world_scan (16 numbers, row-major)",
                            file.string(), what));
}

Eigen::Isometry3d parse_transform(const Json& value, const std::filesystem::path& file,
                                  const std::string& name) {
    if (!value.is_array() || value.size() != 16) {
        refuse(file, fmt::format("{} is not a list of 16 numbers", name));
    }
    Eigen::Matrix4d m;
    for (int i = 0; i < 16; ++i) {
        const Json& number = value[static_cast<std::size_t>(i)];
        if (!number.is_number())
            refuse(file, fmt::format("{} holds something else than numbers", name));
        m(i / 4, i % 4) = number.get<double>();
    }
    const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
    const bool rigid = m.allFinite() &&
                       (r * r.transpose() - Eigen::Matrix3d::Identity()).norm() < kRigidTolerance &&
                       r.determinant() > 0.0 &&
                       (m.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kRigidTolerance;
    if (!rigid) {
        refuse(file, fmt::format("{} is not a rigid motion (a rotation and a shift)", name));
    }
    // The nearest rotation, so that rounding in the file does not shear the cloud. One that is
    // already as good as doubles get is kept to the last bit.
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = r;
    if ((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-12) {
        const Eigen::JacobiSVD<Eigen::Matrix3d> svd(r, Eigen::ComputeFullU | Eigen::ComputeFullV);
        T.linear() = svd.matrixU() * svd.matrixV().transpose();
    }
    T.translation() = m.topRightCorner<3, 1>();
    return T;
}

Json transform_json(const Eigen::Isometry3d& T) {
    Json numbers = Json::array();
    for (int i = 0; i < 16; ++i)
        numbers.push_back(T.matrix()(i / 4, i % 4));
    return numbers;
}

Vec3d parse_vector(const Json& value, const std::filesystem::path& file, const std::string& name) {
    if (!value.is_array() || value.size() != 3 || !value[0].is_number() || !value[1].is_number() ||
        !value[2].is_number()) {
        refuse(file, fmt::format("{} is not a list of 3 numbers", name));
    }
    return {value[0].get<double>(), value[1].get<double>(), value[2].get<double>()};
}

PoseStatus parse_status(const std::string& text, const std::filesystem::path& file) {
    for (const PoseStatus status : {PoseStatus::kReference, PoseStatus::kRegistered,
                                    PoseStatus::kPrior, PoseStatus::kUnregistered}) {
        if (text == to_string(status)) return status;
    }
    refuse(file, fmt::format("the status \"{}\" is none of registered, reference, prior and "
                             "unregistered",
                             text));
}

std::optional<double> number_if_any(const Json& object, const char* key) {
    const auto found = object.find(key);
    if (found == object.end() || !found->is_number()) return std::nullopt;
    return found->get<double>();
}

double number_or_zero(const Json& object, const char* key) {
    return number_if_any(object, key).value_or(0.0);
}

Json number_or_null(const std::optional<double>& number) {
    return number ? Json(*number) : Json(nullptr);
}

Json axes_json(const std::vector<WeakAxis>& axes) {
    Json list = Json::array();
    for (const WeakAxis& axis : axes) {
        list.push_back({{"motion", axis.rotation ? "rotation" : "translation"},
                        {"axis", {axis.axis.x, axis.axis.y, axis.axis.z}},
                        {"information", axis.information}});
    }
    return list;
}

std::vector<WeakAxis> parse_axes(const Json& object, const std::filesystem::path& file) {
    std::vector<WeakAxis> axes;
    const auto found = object.find("weak_axes");
    if (found == object.end() || !found->is_array()) return axes;
    for (const Json& entry : *found) {
        if (!entry.is_object() || !entry.contains("axis")) continue;
        axes.push_back({entry.value("motion", "") == "rotation",
                        parse_vector(entry["axis"], file, "weak_axes[].axis"),
                        number_or_zero(entry, "information")});
    }
    return axes;
}

}  // namespace

std::string to_string(PoseStatus status) {
    switch (status) {
        case PoseStatus::kReference:
            return "reference";
        case PoseStatus::kRegistered:
            return "registered";
        case PoseStatus::kPrior:
            return "prior";
        case PoseStatus::kUnregistered:
            return "unregistered";
    }
    return "unregistered";
}

Poses parse_poses(const std::string& text, const std::filesystem::path& file) {
    const Json root = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    if (root.is_discarded()) refuse(file, "this is not JSON");
    if (!root.is_object() || !root.contains("scans") || !root["scans"].is_array()) {
        refuse(file, "the list \"scans\" is missing");
    }
    Poses poses;
    if (root.contains("origin")) poses.origin = parse_vector(root["origin"], file, "origin");
    for (const Json& entry : root["scans"]) {
        if (!entry.is_object() || !entry.contains("file") || !entry["file"].is_string()) {
            refuse(file, "an entry of \"scans\" has no \"file\"");
        }
        ScanPose pose{.file = entry["file"].get<std::string>(),
                      .status = PoseStatus::kPrior,
                      .weak_axes = {}};
        if (entry.contains("status") && entry["status"].is_string()) {
            pose.status = parse_status(entry["status"].get<std::string>(), file);
        }
        if (entry.contains("T_world_scan") && !entry["T_world_scan"].is_null()) {
            pose.T_world_scan = parse_transform(entry["T_world_scan"], file,
                                                fmt::format("T_world_scan of {}", pose.file));
        } else if (pose.status != PoseStatus::kUnregistered) {
            refuse(file, fmt::format("{} has no T_world_scan", pose.file));
        }
        pose.rmse = number_or_zero(entry, "rmse");
        pose.overlap = number_or_zero(entry, "overlap");
        pose.loop_misclosure = number_if_any(entry, "loop_misclosure");
        pose.loop_misclosure_deg = number_if_any(entry, "loop_misclosure_deg");
        pose.weak_axes = parse_axes(entry, file);
        poses.scans.push_back(std::move(pose));
    }
    if (!root.contains("pairs") || !root["pairs"].is_array()) return poses;
    for (const Json& entry : root["pairs"]) {
        if (!entry.is_object() || !entry.contains("source") || !entry.contains("target") ||
            !entry["source"].is_string() || !entry["target"].is_string() ||
            !entry.contains("T_target_source")) {
            refuse(file, "an entry of \"pairs\" lacks source, target or T_target_source");
        }
        PairPose pair{.source = entry["source"].get<std::string>(),
                      .target = entry["target"].get<std::string>(),
                      .weak_axes = {}};
        pair.T_target_source = parse_transform(entry["T_target_source"], file, "T_target_source");
        pair.overlap = number_or_zero(entry, "overlap");
        pair.contradicted = number_or_zero(entry, "contradicted");
        pair.rmse = number_or_zero(entry, "rmse");
        pair.p95 = number_or_zero(entry, "p95");
        pair.inliers =
            static_cast<std::uint64_t>(std::clamp(number_or_zero(entry, "inliers"), 0.0, 9.0e15));
        pair.accepted = entry.contains("accepted") && entry["accepted"].is_boolean() &&
                        entry["accepted"].get<bool>();
        pair.weak_axes = parse_axes(entry, file);
        poses.pairs.push_back(std::move(pair));
    }
    return poses;
}

Poses read_poses(const std::filesystem::path& file) {
    std::error_code failed;
    if (!std::filesystem::is_regular_file(file, failed)) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("{}: there is no such poses file; check the path", file.string()));
    }
    if (std::filesystem::file_size(file, failed) > kLargestFile || failed) {
        refuse(file, "this is too large to be a poses file");
    }
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    if (!in || !(text << in.rdbuf())) {
        throw Error(
            ExitCode::kUnreadable,
            fmt::format("{}: the poses cannot be read; check its permissions and that it is "
                        "not empty",
                        file.string()));
    }
    return parse_poses(text.str(), file);
}

std::string format_poses(const Poses& poses) {
    Json root{{"frame", "world"}, {"origin", {poses.origin.x, poses.origin.y, poses.origin.z}}};
    root["scans"] = Json::array();
    for (const ScanPose& pose : poses.scans) {
        Json entry{{"file", pose.file}};
        const bool placed = pose.status != PoseStatus::kUnregistered;
        entry["T_world_scan"] = placed ? transform_json(pose.T_world_scan) : Json(nullptr);
        entry["status"] = to_string(pose.status);
        entry["rmse"] = pose.rmse;
        entry["overlap"] = pose.overlap;
        entry["loop_misclosure"] = number_or_null(pose.loop_misclosure);
        entry["loop_misclosure_deg"] = number_or_null(pose.loop_misclosure_deg);
        entry["weak_axes"] = axes_json(pose.weak_axes);
        root["scans"].push_back(std::move(entry));
    }
    root["pairs"] = Json::array();
    for (const PairPose& pair : poses.pairs) {
        root["pairs"].push_back({{"source", pair.source},
                                 {"target", pair.target},
                                 {"T_target_source", transform_json(pair.T_target_source)},
                                 {"overlap", pair.overlap},
                                 {"contradicted", pair.contradicted},
                                 {"rmse", pair.rmse},
                                 {"p95", pair.p95},
                                 {"inliers", pair.inliers},
                                 {"accepted", pair.accepted},
                                 {"weak_axes", axes_json(pair.weak_axes)}});
    }
    // A file name need not be UTF-8: what is not is replaced rather than thrown about.
    return root.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_poses(const Poses& poses, const std::filesystem::path& file) {
    AtomicFile out(file);
    out.write(format_poses(poses));
    out.commit();
}

std::string pose_file(const Scan& scan) {
    const std::size_t hash = scan.name.rfind('#');
    const bool one_of_several =
        hash != std::string::npos && hash + 1 < scan.name.size() &&
        scan.name.find_first_not_of("0123456789", hash + 1) == std::string::npos &&
        !scan.file.string().ends_with(scan.name.substr(hash));
    return scan.file.string() + (one_of_several ? scan.name.substr(hash) : "");
}

const ScanPose* find_pose(const Poses& poses, const Scan& scan) {
    const std::string wanted = pose_file(scan);
    for (const ScanPose& pose : poses.scans) {
        if (pose.file == wanted) return &pose;
    }
    const auto name_of = [](const std::string& path) {
        return std::filesystem::path(path).filename().string();
    };
    const ScanPose* found = nullptr;
    for (const ScanPose& pose : poses.scans) {
        if (name_of(pose.file) != name_of(wanted)) continue;
        if (found != nullptr) return nullptr;
        found = &pose;
    }
    return found;
}

}  // namespace glowworm
