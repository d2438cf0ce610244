#include <fmt/format.h>

#include <algorithm>

#include "preprocess/register/align.h"
#include "preprocess/register/scan_name.h"

namespace glowworm {
namespace {

std::string describe(const std::vector<WeakAxis>& weak) {
    std::string text;
    for (const WeakAxis& w : weak) {
        text +=
            fmt::format("{}{} ({:.2f} {:.2f} {:.2f})", text.empty() ? "" : ", ",
                        w.rotation ? "turn about" : "shift along", w.axis.x, w.axis.y, w.axis.z);
    }
    return text.empty() ? std::string("-") : text;
}

/// "-" for what nothing was measured of.
std::string cell(bool measured, double value, int decimals) {
    return measured ? fmt::format("{:.{}f}", value, decimals) : std::string("-");
}

}  // namespace

std::string trust_table(const Registration& registration) {
    const Poses& poses = registration.poses;
    std::size_t width = 6;
    for (const ScanPose& pose : poses.scans)
        width = std::max(width, short_name(pose.file).size());

    std::string text = fmt::format("{:<{}}  {:<12} {:>9} {:>8} {:>8} {:>8}  weak axes\n", "scan",
                                   width, "status", "overlap %", "rmse mm", "loop mm", "loop deg");
    for (const ScanPose& pose : poses.scans) {
        const bool paired = pose.overlap > 0.0;
        text += fmt::format(
            "{:<{}}  {:<12} {:>9} {:>8} {:>8} {:>8}  {}\n", short_name(pose.file), width,
            to_string(pose.status), cell(paired, 100.0 * pose.overlap, 0),
            cell(paired, 1000.0 * pose.rmse, 1),
            cell(pose.loop_misclosure.has_value(), 1000.0 * pose.loop_misclosure.value_or(0.0), 1),
            cell(pose.loop_misclosure_deg.has_value(), pose.loop_misclosure_deg.value_or(0.0), 3),
            describe(pose.weak_axes));
    }
    if (std::none_of(poses.pairs.begin(), poses.pairs.end(),
                     [](const PairPose& pair) { return pair.accepted; })) {
        return text;
    }
    text +=
        fmt::format("\n{:<{}}  {:<{}} {:>9} {:>9} {:>8} {:>8} {:>8}  weak axes\n", "source", width,
                    "target", width, "overlap %", "through %", "rmse mm", "p95 mm", "inliers");
    for (const PairPose& pair : poses.pairs) {
        if (!pair.accepted) continue;
        text += fmt::format("{:<{}}  {:<{}} {:>9.0f} {:>9.1f} {:>8.1f} {:>8.1f} {:>8}  {}\n",
                            short_name(pair.source), width, short_name(pair.target), width,
                            100.0 * pair.overlap, 100.0 * pair.contradicted, 1000.0 * pair.rmse,
                            1000.0 * pair.p95, pair.inliers, describe(pair.weak_axes));
    }
    return text;
}

std::string distrust(const Registration& registration) {
    std::vector<std::string> unplaced, loose;
    for (const ScanPose& pose : registration.poses.scans) {
        if (pose.status == PoseStatus::kUnregistered) unplaced.push_back(short_name(pose.file));
    }
    for (const std::size_t i : registration.loose)
        loose.push_back(short_name(registration.poses.scans[i].file));
    const auto names = [](const std::vector<std::string>& list) {
        constexpr std::size_t kNamed = 8;
        const std::size_t named = std::min(list.size(), kNamed);
        const std::string text = fmt::format(
            "{}", fmt::join(list.begin(), list.begin() + static_cast<std::ptrdiff_t>(named), ", "));
        return list.size() > named ? fmt::format("{} and {} more", text, list.size() - named)
                                   : text;
    };
    const std::size_t scans = registration.poses.scans.size();
    std::string text;
    if (!unplaced.empty()) {
        text = fmt::format("{} of {} scans could not be placed ({})", unplaced.size(), scans,
                           names(unplaced));
    }
    if (!loose.empty()) {
        text += fmt::format(
            "{}{} of {} scans can shift or turn along an axis that nothing they see holds ({})",
            text.empty() ? "" : "; ", loose.size(), scans, names(loose));
    }
    return text;
}

}  // namespace glowworm
