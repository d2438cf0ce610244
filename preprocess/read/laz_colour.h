#pragma once

#include <array>
#include <cstdint>

#include "preprocess/read/laz_integer.h"

namespace glowworm {

using Rgb16 = std::array<std::uint16_t, 3>;

/// 16-bit colours by their bytes: red is predicted by the last red, green and blue by how the
/// channels before them changed.
class ColourDecoder {
  public:
    void reset() {
        changed_.retire();
        for (SymbolModel& model : bytes_)
            model.retire();
    }

    Rgb16 next(ArithmeticDecoder& decoder, const Rgb16& last) {
        const std::uint32_t changed = next_symbol(decoder, changed_, 128);
        std::array<int, 3> low{}, high{};
        low[0] = changed & 1 ? byte(decoder, 0, last[0] & 255) : last[0] & 255;
        high[0] = changed & 2 ? byte(decoder, 1, last[0] >> 8) : last[0] >> 8;
        if ((changed & 64) == 0) {  // grey
            const auto grey = static_cast<std::uint16_t>(low[0] | high[0] << 8);
            return {grey, grey, grey};
        }
        int step = low[0] - (last[0] & 255);
        low[1] = changed & 4 ? byte(decoder, 2, clamped(step + (last[1] & 255))) : last[1] & 255;
        if (changed & 16) {
            step = (step + low[1] - (last[1] & 255)) / 2;
            low[2] = byte(decoder, 4, clamped(step + (last[2] & 255)));
        } else {
            low[2] = last[2] & 255;
        }
        step = high[0] - (last[0] >> 8);
        high[1] = changed & 8 ? byte(decoder, 3, clamped(step + (last[1] >> 8))) : last[1] >> 8;
        if (changed & 32) {
            step = (step + high[1] - (last[1] >> 8)) / 2;
            high[2] = byte(decoder, 5, clamped(step + (last[2] >> 8)));
        } else {
            high[2] = last[2] >> 8;
        }
        Rgb16 colour{};
        for (std::size_t i = 0; i < 3; ++i) {
            colour[i] = static_cast<std::uint16_t>(low[i] | high[i] << 8);
        }
        return colour;
    }

  private:
    int byte(ArithmeticDecoder& decoder, std::size_t model, int predicted) {
        return (predicted + static_cast<int>(next_symbol(decoder, bytes_[model], 256))) & 255;
    }
    static int clamped(int value) { return std::clamp(value, 0, 255); }

    SymbolModel changed_;
    std::array<SymbolModel, 6> bytes_;
};

}  // namespace glowworm
