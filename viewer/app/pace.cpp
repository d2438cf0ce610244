#include "viewer/app/pace.h"

#include <algorithm>

namespace glowworm {
namespace {

constexpr double kMovingSeconds = 0.1, kRestingSeconds = 0.5;
constexpr double kNewShare = 0.5;  // of the latest frame in what is expected of the next

}  // namespace

int Pace::divisor(bool moving) const {
    const double most = moving ? kMovingSeconds : kRestingSeconds;
    for (std::size_t i = 0; i < kDivisors.size(); ++i) {
        const double seconds = expected(i);
        if (seconds > 0.0 && seconds <= most) return kDivisors[i];
    }
    return kDivisors.back();  // also the first picture, which comes at once
}

double Pace::expected(std::size_t fineness) const {
    // From the nearest that was drawn; of two as near, the coarser.
    for (std::size_t away = 0; away < kDivisors.size(); ++away) {
        for (const std::size_t i : {fineness + away, fineness - away}) {
            if (i < kDivisors.size() && seconds_[i] > 0.0)
                return seconds_[i] * kDivisors[i] / kDivisors[fineness];
        }
    }
    return 0.0;
}

void Pace::drawn(int divisor, double seconds) {
    const auto drawn = std::size_t(std::ranges::find(kDivisors, divisor) - kDivisors.begin());
    double& latest = seconds_[drawn];
    latest = latest > 0.0 ? kNewShare * seconds + (1.0 - kNewShare) * latest : seconds;

    // What was learnt of the others holds within what pixels alone, and nothing of them, allow.
    for (std::size_t i = 0; i < kDivisors.size(); ++i) {
        if (seconds_[i] == 0.0) continue;
        const double by_pixels = double(divisor * divisor) / (kDivisors[i] * kDivisors[i]);
        const auto [least, most] = std::minmax({latest, latest * by_pixels});
        seconds_[i] = std::clamp(seconds_[i], least, most);
    }
}

}  // namespace glowworm
