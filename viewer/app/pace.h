#pragma once

namespace glowworm {

/// How finely a window draws: a frame of 1/d x 1/d of its pixels costs about 1/d² of the time, so
/// movement stays fluent where the machine is slow, and what stands still becomes sharp.
class Pace {
  public:
    /// The finest of 1, 2, 3, 4, 6, 8 whose frame is expected to take at most a tenth of a second
    /// in movement and a second and a half at rest; 8 where none is, and at first.
    int divisor(bool moving) const;

    /// A frame drawn at `divisor` took `seconds`.
    void drawn(int divisor, double seconds);

  private:
    double full_seconds_ = 0.0;  ///< of a frame at divisor 1
    bool measured_ = false;
};

}  // namespace glowworm
