#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "preprocess/read/input_file.h"

// The adaptive arithmetic decoder that LASzip's streams are written for: 32-bit interval, byte-wise
// renormalisation, models updated at growing periods (A. Said, "Introduction to Arithmetic Coding",
// HP Labs report HPL-2004-76, sections 2 and 3). Only the bits of the stream are theirs.

namespace glowworm {

/// The bytes [begin, end) of a file one after the other, from 32 KiB of memory.
class ByteSource {
  public:
    void open(const InputFile& file, std::uint64_t begin, std::uint64_t end);

    /// The next byte. Past the end there are a few zeros, since some writers leave the last of them
    /// out; then Error (kUnreadable).
    std::uint32_t next() {
        if (at_ == stop_) refill();
        return *at_++;
    }

  private:
    void refill();

    const InputFile* file_ = nullptr;
    std::uint64_t position_ = 0, end_ = 0;  // in the file, of what is not in the buffer yet
    std::vector<std::uint8_t> buffer_;
    const std::uint8_t* at_ = nullptr;
    const std::uint8_t* stop_ = nullptr;
    bool padded_ = false;
};

/// How often each of `symbols` symbols came so far, as the decoder needs it. A model without
/// symbols is not in use; copies are not needed.
class SymbolModel {
  public:
    /// All of `symbols` symbols (2..1024) equally likely.
    void reset(std::uint32_t symbols);
    /// Not in use until the next reset; keeps its memory.
    void retire() { symbols_ = 0; }
    bool in_use() const { return symbols_ != 0; }

  private:
    friend class ArithmeticDecoder;
    void update();

    std::uint16_t* distribution() { return storage_.get(); }  // [symbols], in 1/32768
    std::uint16_t* counts() { return storage_.get() + symbols_; }
    std::uint16_t* table() { return storage_.get() + 2 * symbols_; }

    std::unique_ptr<std::uint16_t[]> storage_;
    std::uint32_t symbols_ = 0, capacity_ = 0;
    std::uint32_t table_size_ = 0, table_shift_ = 0;  // no table for 16 symbols or fewer
    std::uint32_t total_ = 0, cycle_ = 0, until_update_ = 0;
};

/// The same for one bit.
class BitModel {
  public:
    void reset() { *this = BitModel(); }

  private:
    friend class ArithmeticDecoder;
    void update();

    std::uint32_t zero_count_ = 1, count_ = 2;
    std::uint32_t zero_probability_ = 1u << 12;  // in 1/8192
    std::uint32_t cycle_ = 4, until_update_ = 4;
};

class ArithmeticDecoder {
  public:
    /// Begins with the bytes [begin, end) of `file`.
    void open(const InputFile& file, std::uint64_t begin, std::uint64_t end) {
        source_.open(file, begin, end);
        length_ = 0xffffffffu;
        value_ = 0;
        for (int i = 0; i < 4; ++i)
            value_ = (value_ << 8) | source_.next();
    }

    /// The next symbol, below the number of the model's symbols whatever the bytes are.
    std::uint32_t symbol(SymbolModel& model) {
        const std::uint16_t* distribution = model.distribution();
        const std::uint32_t step = length_ >> 15;
        const std::uint32_t target = std::min(value_ / step, 32767u);
        std::uint32_t low = 0, high = model.symbols_;
        if (model.table_size_ != 0) {
            const std::uint16_t* entry = model.table() + (target >> model.table_shift_);
            low = entry[0];
            high = entry[1] + 1u;
        }
        while (high > low + 1) {
            const std::uint32_t middle = (low + high) >> 1;
            if (distribution[middle] > target) {
                high = middle;
            } else {
                low = middle;
            }
        }
        const std::uint32_t below = distribution[low] * step;
        const std::uint32_t above =
            low + 1 == model.symbols_ ? length_ : distribution[low + 1] * step;
        value_ -= below;
        length_ = above - below;
        renormalise();
        ++model.counts()[low];
        if (--model.until_update_ == 0) model.update();
        return low;
    }

    std::uint32_t bit(BitModel& model) {
        const std::uint32_t split = model.zero_probability_ * (length_ >> 13);
        const bool one = value_ >= split;
        if (one) {
            value_ -= split;
            length_ -= split;
        } else {
            length_ = split;
            ++model.zero_count_;
        }
        renormalise();
        if (--model.until_update_ == 0) model.update();
        return one ? 1 : 0;
    }

    /// `count` (1..32) bits stored without a model.
    std::uint32_t raw_bits(std::uint32_t count) {
        if (count > 19) {
            const std::uint32_t low = raw_bits(16);
            return low | raw_bits(count - 16) << 16;
        }
        length_ >>= count;
        const std::uint32_t bits = std::min(value_ / length_, (1u << count) - 1);
        value_ -= bits * length_;
        renormalise();
        return bits;
    }

    std::uint64_t raw_64() {
        const std::uint64_t low = raw_bits(32);
        return low | std::uint64_t{raw_bits(32)} << 32;
    }

  private:
    void renormalise() {
        while (length_ < (1u << 24)) {
            value_ = (value_ << 8) | source_.next();
            length_ <<= 8;
        }
    }

    ByteSource source_;
    std::uint32_t value_ = 0, length_ = 0;
};

}  // namespace glowworm
