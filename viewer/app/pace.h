#pragma once

#include <array>
#include <cstddef>

namespace glowworm {

/// How finely a window draws: movement stays fluent where the machine is slow, and what stands
/// still becomes sharp. Part of a frame's time goes with its pixels and part with the cave, so what
/// each fineness takes is learnt by drawing it; one never drawn is expected to lie halfway between
/// the two (time as 1/d for a frame of 1/d x 1/d of the pixels).
class Pace {
  public:
    /// The finest of 1, 2, 3, 4, 6, 8 whose frame is expected to take at most a tenth of a second
    /// in movement and half a second at rest; 8 where none is, and at first.
    int divisor(bool moving) const;

    /// A frame drawn at `divisor` (one of those above) took `seconds` > 0.
    void drawn(int divisor, double seconds);

  private:
    static constexpr std::array kDivisors{1, 2, 3, 4, 6, 8};

    double expected(std::size_t fineness) const;

    std::array<double, kDivisors.size()> seconds_{};  ///< by fineness; 0 = never drawn
};

}  // namespace glowworm
