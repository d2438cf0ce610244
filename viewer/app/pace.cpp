#include "viewer/app/pace.h"

namespace glowworm {
namespace {

constexpr int kDivisors[] = {1, 2, 3, 4, 6, 8};
constexpr double kMovingSeconds = 0.1, kRestingSeconds = 1.5;
constexpr double kNewShare = 0.5;  // of the latest frame in what is expected of the next

}  // namespace

int Pace::divisor(bool moving) const {
    if (!measured_) return kDivisors[5];  // the first picture comes at once
    const double most = moving ? kMovingSeconds : kRestingSeconds;
    for (const int divisor : kDivisors) {
        if (full_seconds_ <= most * divisor * divisor) return divisor;
    }
    return kDivisors[5];
}

void Pace::drawn(int divisor, double seconds) {
    const double full = seconds * divisor * divisor;
    full_seconds_ = measured_ ? kNewShare * full + (1.0 - kNewShare) * full_seconds_ : full;
    measured_ = true;
}

}  // namespace glowworm
