#pragma once

#include <array>
#include <cstdint>

#include "preprocess/read/laz_integer.h"

namespace glowworm {

/// GPS times (the bits of a double) as multiples of the last differences in up to four interleaved
/// sequences. `Unchanged` tells the two forms apart: in point formats 0 to 5 a symbol says that the
/// time is the last one; from format 6 on that is known beforehand.
template <bool kUnchangedIsCoded>
class GpsTimeDecoder {
  public:
    void start(std::uint64_t time) {
        times_ = {time, 0, 0, 0};
        differences_ = {};
        extremes_ = {};
        last_ = newest_ = 0;
        multiples_.retire();
        without_difference_.retire();
        integers_.reset();
    }

    std::uint64_t time() const { return times_[last_]; }

    std::uint64_t next(ArithmeticDecoder& decoder) {
        // A switch to another sequence is followed by that sequence's own symbol, one of the four
        // at most three times in what any writer makes; the bound is for damaged files.
        for (int switches = 0; switches < 64; ++switches) {
            const bool done =
                differences_[last_] == 0 ? after_no_difference(decoder) : after_difference(decoder);
            if (done) break;
        }
        return times_[last_];
    }

  private:
    static constexpr std::uint32_t kLargest = 500;  // multiple of the last difference
    static constexpr std::int32_t kSmallest = -10;
    static constexpr std::uint32_t kUnchanged = kLargest - kSmallest + 1;
    static constexpr std::uint32_t kFull = kUnchanged + (kUnchangedIsCoded ? 1 : 0);
    static constexpr std::uint32_t kSymbols = kFull + 4;

    bool after_no_difference(ArithmeticDecoder& decoder) {
        std::uint32_t symbol = next_symbol(decoder, without_difference_, kUnchangedIsCoded ? 6 : 5);
        if (kUnchangedIsCoded) {
            if (symbol == 0) return true;
            --symbol;
        }
        if (symbol == 0) {
            differences_[last_] = integers_.next(decoder, 0, 0);
            advance(differences_[last_]);
            extremes_[last_] = 0;
            return true;
        }
        if (symbol == 1) {
            read_full(decoder);
            return true;
        }
        last_ = (last_ + symbol - 1) & 3;
        return false;
    }

    bool after_difference(ArithmeticDecoder& decoder) {
        const std::uint32_t symbol = next_symbol(decoder, multiples_, kSymbols);
        const std::int32_t unit = differences_[last_];
        if (symbol == 1) {
            advance(integers_.next(decoder, unit, 1));
            extremes_[last_] = 0;
        } else if (symbol == 0) {
            advance_extreme(integers_.next(decoder, 0, 7));
        } else if (symbol < kLargest) {
            advance(integers_.next(decoder, times(symbol, unit), symbol < 10 ? 2 : 3));
        } else if (symbol == kLargest) {
            advance_extreme(integers_.next(decoder, times(symbol, unit), 4));
        } else if (symbol < kUnchanged) {
            const std::int32_t multiple = -static_cast<std::int32_t>(symbol - kLargest);
            const std::int32_t predicted = wrapping_multiply(multiple, unit);
            if (multiple > kSmallest) {
                advance(integers_.next(decoder, predicted, 5));
            } else {
                advance_extreme(integers_.next(decoder, predicted, 6));
            }
        } else if (symbol == kFull) {
            read_full(decoder);
        } else if (symbol > kFull) {
            last_ = (last_ + symbol - kFull) & 3;
            return false;
        }
        return true;
    }

    static std::int32_t times(std::uint32_t multiple, std::int32_t unit) {
        return wrapping_multiply(static_cast<std::int32_t>(multiple), unit);
    }

    void advance(std::int32_t difference) {
        times_[last_] += static_cast<std::uint64_t>(std::int64_t{difference});
    }

    /// Four differences far from every multiple in a row make the last of them the new unit.
    void advance_extreme(std::int32_t difference) {
        if (++extremes_[last_] > 3) {
            differences_[last_] = difference;
            extremes_[last_] = 0;
        }
        advance(difference);
    }

    void read_full(ArithmeticDecoder& decoder) {
        const auto predicted = static_cast<std::int32_t>(times_[last_] >> 32);
        const auto high = static_cast<std::uint32_t>(integers_.next(decoder, predicted, 8));
        newest_ = (newest_ + 1) & 3;
        times_[newest_] = std::uint64_t{high} << 32 | decoder.raw_bits(32);
        last_ = newest_;
        differences_[last_] = 0;
        extremes_[last_] = 0;
    }

    std::array<std::uint64_t, 4> times_{};
    std::array<std::int32_t, 4> differences_{};
    std::array<int, 4> extremes_{};
    std::uint32_t last_ = 0, newest_ = 0;
    SymbolModel multiples_, without_difference_;
    IntegerDecoder integers_{32, 9};
};

}  // namespace glowworm
