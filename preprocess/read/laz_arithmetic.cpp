#include "preprocess/read/laz_arithmetic.h"

namespace glowworm {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 15;
constexpr std::size_t kPadding = 8;            // zeros handed out past the end of a stream
constexpr std::uint32_t kMaxTotal = 1u << 15;  // counts are halved beyond
constexpr std::uint32_t kMaxBitTotal = 1u << 13;

}  // namespace

void ByteSource::open(const InputFile& file, std::uint64_t begin, std::uint64_t end) {
    file_ = &file;
    position_ = begin;
    end_ = end;
    at_ = stop_ = nullptr;
    padded_ = false;
}

void ByteSource::refill() {
    const auto bytes =
        static_cast<std::size_t>(std::min<std::uint64_t>(end_ - position_, kBufferBytes));
    if (bytes == 0 && padded_) {
        file_->fail("its compressed points end too early; copy it again from where it came from");
    }
    if (buffer_.size() < std::max(bytes, kPadding)) buffer_.resize(std::max(bytes, kPadding));
    if (bytes == 0) {
        padded_ = true;
        std::fill_n(buffer_.begin(), kPadding, std::uint8_t{0});
    } else {
        file_->read_exactly(position_, buffer_.data(), bytes);
    }
    position_ += bytes;
    at_ = buffer_.data();
    stop_ = at_ + (bytes == 0 ? kPadding : bytes);
}

void SymbolModel::reset(std::uint32_t symbols) {
    symbols_ = symbols;
    table_size_ = table_shift_ = 0;
    if (symbols > 16) {
        std::uint32_t table_bits = 3;
        while (symbols > (1u << (table_bits + 2)))
            ++table_bits;
        table_size_ = 1u << table_bits;
        table_shift_ = 15 - table_bits;
    }
    const std::uint32_t needed = 2 * symbols + (table_size_ == 0 ? 0 : table_size_ + 2);
    if (capacity_ < needed) {
        storage_ = std::make_unique_for_overwrite<std::uint16_t[]>(needed);
        capacity_ = needed;
    }
    std::fill_n(counts(), symbols, std::uint16_t{1});
    total_ = 0;
    cycle_ = symbols;
    update();
    cycle_ = until_update_ = (symbols + 6) >> 1;
}

void SymbolModel::update() {
    std::uint16_t* const count = counts();
    total_ += cycle_;
    if (total_ > kMaxTotal) {
        total_ = 0;
        for (std::uint32_t i = 0; i < symbols_; ++i) {
            count[i] = static_cast<std::uint16_t>((count[i] + 1) >> 1);
            total_ += count[i];
        }
    }

    std::uint16_t* const share = distribution();
    const std::uint32_t scale = 0x80000000u / total_;
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < symbols_; ++i) {
        share[i] = static_cast<std::uint16_t>((scale * sum) >> 16);
        sum += count[i];
    }
    if (table_size_ != 0) {
        // Entry t is the last symbol that begins at or below t's first target.
        std::uint16_t* const first = table();
        std::uint32_t entry = 0;
        for (std::uint32_t i = 1; i < symbols_; ++i) {
            const std::uint32_t begins = share[i] >> table_shift_;
            while (entry < begins)
                first[++entry] = static_cast<std::uint16_t>(i - 1);
        }
        first[0] = 0;
        while (entry <= table_size_)
            first[++entry] = static_cast<std::uint16_t>(symbols_ - 1);
    }

    cycle_ = std::min((5 * cycle_) >> 2, (symbols_ + 6) << 3);
    until_update_ = cycle_;
}

void BitModel::update() {
    count_ += cycle_;
    if (count_ > kMaxBitTotal) {
        count_ = (count_ + 1) >> 1;
        zero_count_ = (zero_count_ + 1) >> 1;
        if (zero_count_ == count_) ++count_;
    }
    zero_probability_ = (zero_count_ * (0x80000000u / count_)) >> 18;
    cycle_ = std::min((5 * cycle_) >> 2, 64u);
    until_update_ = cycle_;
}

}  // namespace glowworm
