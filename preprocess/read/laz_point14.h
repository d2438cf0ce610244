#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "preprocess/read/laz_gps_time.h"
#include "preprocess/read/laz_integer.h"

namespace glowworm {

/// The streams that a chunk's POINT14 items are spread over, in the order of the file.
enum class Point14Layer : std::uint32_t {
    kReturnsXy,
    kZ,
    kClassification,
    kFlags,
    kIntensity,
    kScanAngle,
    kUserData,
    kSource,
    kGpsTime,
    kCount,
};

/// A layer of one chunk: absent where nothing in it changes or nobody wants it.
struct LazLayer {
    ArithmeticDecoder decoder;
    bool present = false;
};

using Point14Layers = std::array<LazLayer, static_cast<std::size_t>(Point14Layer::kCount)>;

/// The first 30 bytes of a record of the formats 6 to 10.
struct Point14 {
    std::int32_t x = 0, y = 0, z = 0;
    std::uint16_t intensity = 0;
    std::uint8_t return_number = 0, returns = 0;  ///< 4 bits each
    std::uint8_t flags = 0;                       ///< 4 classification flags, direction, edge
    std::uint8_t channel = 0;                     ///< scanner channel, 0..3
    std::uint8_t classification = 0, user_data = 0;
    std::int16_t scan_angle = 0;
    std::uint16_t source = 0;
    std::uint64_t gps_time = 0;  ///< bits of a double

    void unpack(const std::byte* record);
    void pack(std::byte* record) const;
};

/// POINT14 items. Each of the four scanner channels has models and a last point of its own.
class Point14Decoder {
  public:
    Point14Decoder();
    ~Point14Decoder();

    /// Begins a chunk with its first point.
    void start(const std::byte* record);

    /// Writes the next point's 30 bytes.
    void next(Point14Layers& layers, std::byte* record);

    /// The scanner channel of the point before: the other items' models go by it too.
    std::uint32_t channel() const { return channel_; }

  private:
    struct Context;

    Context& begin_context(std::uint32_t channel, const Point14& point);
    void read_returns(Context& context, ArithmeticDecoder& decoder, std::uint32_t changed);

    std::array<std::unique_ptr<Context>, 4> contexts_;
    std::array<bool, 4> in_use_{};
    std::uint32_t channel_ = 0;
};

}  // namespace glowworm
