#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "preprocess/read/laz_arithmetic.h"

namespace glowworm {

/// Integers of up to 32 bits as LASzip stores them: the difference from a prediction, as the number
/// k of its significant bits, coded in one of several contexts, and then those bits.
class IntegerDecoder {
  public:
    IntegerDecoder(std::uint32_t bits, std::uint32_t contexts)
        : bits_(bits), magnitudes_(contexts), values_(bits + 1) {}

    /// As new.
    void reset() {
        for (SymbolModel& model : magnitudes_)
            model.retire();
        for (SymbolModel& model : values_)
            model.retire();
        lowest_.reset();
    }

    /// The next value of a quantity predicted to be `prediction`; modulo 2^bits, and non-negative
    /// for fewer than 32 bits.
    std::int32_t next(ArithmeticDecoder& decoder, std::int32_t prediction,
                      std::uint32_t context = 0) {
        const std::uint32_t value =
            static_cast<std::uint32_t>(prediction) + difference(decoder, context);
        return static_cast<std::int32_t>(bits_ < 32 ? value & ((1u << bits_) - 1) : value);
    }

    /// k of the value before.
    std::uint32_t magnitude() const { return magnitude_; }

  private:
    std::uint32_t difference(ArithmeticDecoder& decoder, std::uint32_t context) {
        SymbolModel& model = magnitudes_[context];
        if (!model.in_use()) model.reset(bits_ + 1);
        const std::uint32_t k = magnitude_ = decoder.symbol(model);
        if (k == 0) return decoder.bit(lowest_);  // 0 or 1
        if (k == 32) return 0x80000000u;

        // k bits stand for -(2^k - 1) .. -2^(k-1) in the lower half, 2^(k-1) + 1 .. 2^k in the
        // upper. Of more than 8 bits only the highest 8 have a model.
        const std::uint32_t modelled = std::min(k, 8u);
        if (!values_[k].in_use()) values_[k].reset(1u << modelled);
        std::uint32_t value = decoder.symbol(values_[k]);
        if (k > 8) value = value << (k - 8) | decoder.raw_bits(k - 8);
        return value >= (1u << (k - 1)) ? value + 1 : value - ((1u << k) - 1);
    }

    std::uint32_t bits_;
    std::uint32_t magnitude_ = 0;
    std::vector<SymbolModel> magnitudes_;
    std::vector<SymbolModel> values_;
    BitModel lowest_;
};

/// LASzip's running median: of five values in order the largest or the smallest makes room for the
/// new one, by turns that change when a value falls on the other side of the median.
class RunningMedian {
  public:
    std::int32_t median() const { return sorted_[2]; }

    void add(std::int32_t value) {
        const std::int32_t* kept = sorted_.data() + (drop_largest_ ? 0 : 1);
        const std::int32_t a = kept[0], b = kept[1], c = kept[2], d = kept[3];
        const std::int32_t before = sorted_[2];
        sorted_ = {std::min(a, value), std::min(b, std::max(a, value)),
                   std::min(c, std::max(b, value)), std::min(d, std::max(c, value)),
                   std::max(d, value)};
        drop_largest_ = drop_largest_ ? value < before : value <= before;
    }

  private:
    std::array<std::int32_t, 5> sorted_{};
    bool drop_largest_ = true;
};

/// `model`'s next symbol; the model is made ready for `symbols` symbols at its first use.
inline std::uint32_t next_symbol(ArithmeticDecoder& decoder, SymbolModel& model,
                                 std::uint32_t symbols) {
    if (!model.in_use()) model.reset(symbols);
    return decoder.symbol(model);
}

/// A sum modulo 2^32, as LASzip's coordinates are added.
inline std::int32_t wrapping_add(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) + static_cast<std::uint32_t>(b));
}

inline std::int32_t wrapping_multiply(std::int32_t a, std::int32_t b) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(a) * static_cast<std::uint32_t>(b));
}

}  // namespace glowworm
