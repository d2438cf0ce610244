#include "preprocess/read/laz_pointwise.h"

#include <array>
#include <cstring>
#include <vector>

#include "preprocess/read/laz_colour.h"
#include "preprocess/read/laz_gps_time.h"
#include "preprocess/read/laz_integer.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

/// Context of a point's differences, by number of returns and return number. Part of the format.
constexpr std::array<std::array<std::uint8_t, 8>, 8> kReturnContext{{
    {15, 14, 13, 12, 11, 10, 9, 8},
    {14, 0, 1, 3, 6, 10, 10, 9},
    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},
    {11, 6, 7, 8, 9, 13, 13, 12},
    {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14},
    {8, 9, 10, 11, 12, 13, 14, 15},
}};

/// Position, intensity, flags, classification, scan angle, user data and source: 20 bytes.
class Point10Decoder {
  public:
    void start(const std::byte* record) {
        x_ = load<std::int32_t>(record);
        y_ = load<std::int32_t>(record + 4);
        z_ = load<std::int32_t>(record + 8);
        intensity_ = 0;
        std::memcpy(bytes_.data(), record + 14, 4);
        source_ = load<std::uint16_t>(record + 18);

        x_steps_.fill({});
        y_steps_.fill({});
        intensities_.fill(0);
        heights_.fill(0);
        changed_.retire();
        for (auto& models : byte_models_) {
            for (SymbolModel& model : models)
                model.retire();
        }
        for (SymbolModel& model : angle_models_)
            model.retire();
        for (IntegerDecoder* integer :
             {&intensity_values_, &source_values_, &x_values_, &y_values_, &z_values_}) {
            integer->reset();
        }
    }

    void next(ArithmeticDecoder& decoder, std::byte* record) {
        const std::uint32_t changed = next_symbol(decoder, changed_, 64);
        if (changed & 32) replace_byte(decoder, kFlags);
        const std::uint32_t return_number = bytes_[kFlags] & 7u;
        const std::uint32_t returns = (bytes_[kFlags] >> 3) & 7u;
        const std::uint32_t context = kReturnContext[returns][return_number];
        const std::uint32_t level =
            returns > return_number ? returns - return_number : return_number - returns;
        if (changed & 16) {
            intensities_[context] = static_cast<std::uint16_t>(
                intensity_values_.next(decoder, intensities_[context], std::min(context, 3u)));
        }
        // With nothing at all changed not even the intensity of this kind of return is taken.
        if (changed != 0) intensity_ = intensities_[context];
        if (changed & 8) replace_byte(decoder, kClassification);
        if (changed & 4) {
            SymbolModel& model = angle_models_[(bytes_[kFlags] >> 6) & 1u];
            bytes_[kAngle] =
                static_cast<std::uint8_t>(bytes_[kAngle] + next_symbol(decoder, model, 256));
        }
        if (changed & 2) replace_byte(decoder, kUserData);
        if (changed & 1) {
            source_ = static_cast<std::uint16_t>(source_values_.next(decoder, source_));
        }

        const std::uint32_t single = returns == 1 ? 1 : 0;
        const std::int32_t dx = x_values_.next(decoder, x_steps_[context].median(), single);
        x_ = wrapping_add(x_, dx);
        x_steps_[context].add(dx);

        std::uint32_t k = x_values_.magnitude();
        const std::int32_t dy =
            y_values_.next(decoder, y_steps_[context].median(), single + (k < 20 ? k & ~1u : 20));
        y_ = wrapping_add(y_, dy);
        y_steps_[context].add(dy);

        k = (x_values_.magnitude() + y_values_.magnitude()) / 2;
        z_ = z_values_.next(decoder, heights_[level], single + (k < 18 ? k & ~1u : 18));
        heights_[level] = z_;

        store(record, x_);
        store(record + 4, y_);
        store(record + 8, z_);
        store(record + 12, intensity_);
        std::memcpy(record + 14, bytes_.data(), 4);
        store(record + 18, source_);
    }

  private:
    enum Byte { kFlags, kClassification, kAngle, kUserData };

    void replace_byte(ArithmeticDecoder& decoder, Byte which) {
        SymbolModel& model = byte_models_[which == kFlags            ? 0
                                          : which == kClassification ? 1
                                                                     : 2][bytes_[which]];
        bytes_[which] = static_cast<std::uint8_t>(next_symbol(decoder, model, 256));
    }

    std::int32_t x_ = 0, y_ = 0, z_ = 0;
    std::uint16_t intensity_ = 0, source_ = 0;
    std::array<std::uint8_t, 4> bytes_{};

    std::array<RunningMedian, 16> x_steps_, y_steps_;
    std::array<std::uint16_t, 16> intensities_{};
    std::array<std::int32_t, 8> heights_{};
    SymbolModel changed_;
    std::array<std::array<SymbolModel, 256>, 3> byte_models_;  // by the byte before
    std::array<SymbolModel, 2> angle_models_;
    IntegerDecoder intensity_values_{16, 4}, source_values_{16, 1};
    IntegerDecoder x_values_{32, 2}, y_values_{32, 22}, z_values_{32, 20};
};

/// Where a point's waveform lies: decoded only to get to the items after it.
class WavePacketDecoder {
  public:
    void start(const std::byte* record) {
        std::memcpy(last_.data(), record, last_.size());
        difference_ = 0;
        kind_ = 0;
        index_.retire();
        for (SymbolModel& model : kinds_)
            model.retire();
        for (IntegerDecoder* integer : {&differences_, &sizes_, &points_, &directions_}) {
            integer->reset();
        }
    }

    void next(ArithmeticDecoder& decoder, std::byte* record) {
        record[0] = static_cast<std::byte>(next_symbol(decoder, index_, 256));
        const std::byte* last = last_.data();
        auto offset = load<std::uint64_t>(last + 1);
        const auto size = load<std::int32_t>(last + 9);
        kind_ = next_symbol(decoder, kinds_[kind_], 4);
        if (kind_ == 1) {
            offset += static_cast<std::uint32_t>(size);
        } else if (kind_ == 2) {
            difference_ = differences_.next(decoder, difference_);
            offset += static_cast<std::uint64_t>(std::int64_t{difference_});
        } else if (kind_ == 3) {
            offset = decoder.raw_64();
        }
        store(record + 1, offset);
        store(record + 9, sizes_.next(decoder, size));
        store(record + 13, points_.next(decoder, load<std::int32_t>(last + 13)));
        for (std::uint32_t axis = 0; axis < 3; ++axis) {
            const std::size_t at = 17 + 4 * axis;
            store(record + at, directions_.next(decoder, load<std::int32_t>(last + at), axis));
        }
        std::memcpy(last_.data(), record, last_.size());
    }

  private:
    std::array<std::byte, 29> last_{};
    std::int32_t difference_ = 0;
    std::uint32_t kind_ = 0;
    SymbolModel index_;
    std::array<SymbolModel, 4> kinds_;
    IntegerDecoder differences_{32, 1}, sizes_{32, 1}, points_{32, 1}, directions_{32, 3};
};

class PointwiseDecoder final : public LazChunkDecoder {
  public:
    PointwiseDecoder(const InputFile& file, const LazLayout& layout)
        : file_(file), layout_(layout), last_(layout.record_bytes) {
        for (const LazItem& item : layout.items) {
            if (item.type == LazItemType::kByte) byte_models_.resize(item.bytes);
        }
    }

    void start(const LazChunk& chunk) override {
        chunk_ = chunk;
        first_ = true;
    }

    void next(std::byte* record) override {
        if (first_) {
            read_first(record);
        } else {
            for (const LazItem& item : layout_.items)
                decode(item, record + item.offset);
        }
        first_ = false;
        std::memcpy(last_.data(), record, last_.size());
    }

  private:
    /// The first point of a chunk is stored as it is.
    void read_first(std::byte* record) {
        file_.read_exactly(chunk_.begin, record, layout_.record_bytes);
        for (const LazItem& item : layout_.items) {
            const std::byte* part = record + item.offset;
            switch (item.type) {
                case LazItemType::kPoint10:
                    point_.start(part);
                    break;
                case LazItemType::kGpsTime11:
                    time_.start(load<std::uint64_t>(part));
                    break;
                case LazItemType::kRgb12:
                    colour_.reset();
                    break;
                case LazItemType::kWavePacket13:
                    packet_.start(part);
                    break;
                default:
                    for (SymbolModel& model : byte_models_)
                        model.retire();
            }
        }
        if (chunk_.points > 1) {
            decoder_.open(file_, chunk_.begin + layout_.record_bytes, chunk_.end);
        }
    }

    void decode(const LazItem& item, std::byte* part) {
        const std::byte* last = last_.data() + item.offset;
        switch (item.type) {
            case LazItemType::kPoint10:
                point_.next(decoder_, part);
                break;
            case LazItemType::kGpsTime11:
                store(part, time_.next(decoder_));
                break;
            case LazItemType::kRgb12:
                store(part, colour_.next(decoder_, load<Rgb16>(last)));
                break;
            case LazItemType::kWavePacket13:
                packet_.next(decoder_, part);
                break;
            default:
                for (std::size_t i = 0; i < byte_models_.size(); ++i) {
                    part[i] = static_cast<std::byte>(std::to_integer<std::uint32_t>(last[i]) +
                                                     next_symbol(decoder_, byte_models_[i], 256));
                }
        }
    }

    const InputFile& file_;
    const LazLayout& layout_;
    LazChunk chunk_;
    bool first_ = true;
    ArithmeticDecoder decoder_;
    std::vector<std::byte> last_;  // the record before
    Point10Decoder point_;
    GpsTimeDecoder<true> time_;
    ColourDecoder colour_;
    WavePacketDecoder packet_;
    std::vector<SymbolModel> byte_models_;
};

}  // namespace

std::unique_ptr<LazChunkDecoder> make_pointwise_decoder(const InputFile& file,
                                                        const LazLayout& layout) {
    return std::make_unique<PointwiseDecoder>(file, layout);
}

}  // namespace glowworm
