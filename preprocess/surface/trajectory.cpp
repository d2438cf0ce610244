#include "preprocess/surface/trajectory.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numeric>
#include <string>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr std::size_t kMostNumbers = 4;

/// The first four numbers of a line, and whether all its words up to there were numbers.
struct Line {
    double numbers[kMostNumbers] = {};
    std::size_t count = 0;
    bool all_numbers = true;
};

Line parse(std::string_view text) {
    constexpr std::string_view kBetween = " \t\r,;";
    Line line;
    while (line.count < kMostNumbers) {
        const std::size_t begin = text.find_first_not_of(kBetween);
        if (begin == std::string_view::npos) break;
        text.remove_prefix(begin);
        const std::string_view word = text.substr(0, text.find_first_of(kBetween));
        double& number = line.numbers[line.count];
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
        if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(number)) {
            line.all_numbers = false;
            break;
        }
        ++line.count;
        text.remove_prefix(word.size());
    }
    return line;
}

void sort_by_time(Trajectory& trajectory) {
    std::vector<std::size_t> order(trajectory.times.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return trajectory.times[a] < trajectory.times[b];
    });
    Trajectory sorted;
    for (const std::size_t i : order) {
        sorted.positions.push_back(trajectory.positions[i]);
        sorted.times.push_back(trajectory.times[i]);
    }
    trajectory = std::move(sorted);
}

}  // namespace

Trajectory read_trajectory(const std::filesystem::path& path) {
    const std::string name = "The trajectory \"" + path.string() + "\"";
    std::ifstream file;
    if (std::filesystem::is_regular_file(path)) file.open(path, std::ios::binary);
    if (!file.is_open()) {
        throw Error(ExitCode::kUnreadable, name + " cannot be read; check the path.");
    }
    Trajectory trajectory;
    std::size_t row = 0, columns = 0;
    for (std::string text; std::getline(file, text);) {
        ++row;
        const std::size_t first = text.find_first_not_of(" \t\r");
        if (first == std::string::npos || text[first] == '#') continue;
        const Line line = parse(text);
        if (!line.all_numbers && line.count == 0 && trajectory.empty()) continue;
        if (columns == 0) columns = line.count;
        if (line.count < 3 || line.count != columns) {
            throw Error(ExitCode::kUnreadable,
                        name + " has no position in line " + std::to_string(row) +
                            "; lines of \"x y z\" or \"time x y z\" are expected.");
        }
        const double* xyz = line.numbers + (columns - 3);
        trajectory.positions.push_back({xyz[0], xyz[1], xyz[2]});
        if (columns > 3) trajectory.times.push_back(line.numbers[0]);
    }
    if (trajectory.empty()) {
        throw Error(ExitCode::kDegenerate,
                    name + " has no poses; lines of \"x y z\" or \"time x y z\" are expected.");
    }
    if (!trajectory.times.empty()) sort_by_time(trajectory);
    return trajectory;
}

Trajectory thin_trajectory(const Trajectory& trajectory, double spacing) {
    Trajectory thin;
    for (std::size_t i = 0; i < trajectory.positions.size(); ++i) {
        const Vec3d& p = trajectory.positions[i];
        if (!thin.empty() && length(p - thin.positions.back()) < spacing) continue;
        thin.positions.push_back(p);
        if (!trajectory.times.empty()) thin.times.push_back(trajectory.times[i]);
    }
    return thin;
}

}  // namespace glowworm
