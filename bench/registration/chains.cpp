// Chains of sparse scans in narrow simulated passages: how many stations are placed, and none
// wrongly. A line per chain, then their sum.
// usage: bench_chains [stations 12] [points 10000] [chains 4] [metres apart 3] [radius 0.9]
//                     [first seed 1] [noise in metres 0.003]
#include <fmt/format.h>
#include <sys/resource.h>

#include <chrono>
#include <ctime>
#include <string>

#include "preprocess/register/align.h"
#include "tests/register/simulated_chain.h"

using namespace glowworm;
using Clock = std::chrono::steady_clock;

namespace {

constexpr double kWrongShift = 150.0;  // mm: a pair that is this far off was not found but believed
constexpr double kWrongTurn = 3.0;     // degrees

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

struct Outcome {
    std::size_t placed = 0, scans = 0, false_pairs = 0, tried = 0;
    double worst_mm = 0.0;  ///< of an accepted pair
    double wall = 0.0, processor = 0.0;
};

Outcome run(const testing::Chain& chain) {
    Outcome outcome{.scans = chain.scans.size()};
    const Clock::time_point start = Clock::now();
    const double processor = processor_seconds();
    const Registration result = align_scans(chain.scans, {});
    outcome.wall = std::chrono::duration<double>(Clock::now() - start).count();
    outcome.processor = processor_seconds() - processor;
    outcome.placed = outcome.scans - result.unregistered;
    outcome.tried = result.pairs_tried;
    const auto index = [&](const std::string& file) {
        std::size_t i = 0;
        while (pose_file(chain.scans[i]) != file)
            ++i;
        return i;
    };
    for (const PairPose& pair : result.poses.pairs) {
        if (!pair.accepted) continue;
        const testing::PoseError e =
            testing::pose_error(pair.T_target_source, chain.truth[index(pair.target)].inverse() *
                                                          chain.truth[index(pair.source)]);
        if (e.millimetres > kWrongShift || e.degrees > kWrongTurn) ++outcome.false_pairs;
        outcome.worst_mm = std::max(outcome.worst_mm, e.millimetres);
    }
    return outcome;
}

void print(const std::string& name, const Outcome& o) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    fmt::print("| {} | {}/{} | {} | {:.1f} | {} | {:.1f} | {:.1f} | {} |\n", name, o.placed,
               o.scans, o.false_pairs, o.worst_mm, o.tried, o.processor, o.wall,
               usage.ru_maxrss / 1024);
    std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
    const auto number = [&](int i, double fallback) {
        return argc > i ? std::stod(argv[i]) : fallback;
    };
    const testing::ChainSettings settings{.stations = static_cast<std::size_t>(number(1, 12)),
                                          .points = static_cast<std::size_t>(number(2, 10000)),
                                          .apart = number(4, 3.0),
                                          .radius = number(5, 0.9),
                                          .noise = number(7, 0.003)};
    const unsigned chains = static_cast<unsigned>(number(3, 4));
    const unsigned first = static_cast<unsigned>(number(6, 1));
    fmt::print(
        "| chain | placed | false pairs | worst pair mm | pairs tried | processor s | wall s "
        "| peak MB |\n|---|---|---|---|---|---|---|---|\n");
    Outcome sum;
    for (unsigned seed = first; seed < first + chains; ++seed) {
        const Outcome o = run(testing::chain_of_stations(settings, seed));
        print(fmt::format("{} stations of {} points, seed {}", settings.stations, settings.points,
                          seed),
              o);
        sum.placed += o.placed;
        sum.scans += o.scans;
        sum.false_pairs += o.false_pairs;
        sum.tried += o.tried;
        sum.worst_mm = std::max(sum.worst_mm, o.worst_mm);
        sum.wall += o.wall;
        sum.processor += o.processor;
    }
    print("all", sum);
    return 0;
}
