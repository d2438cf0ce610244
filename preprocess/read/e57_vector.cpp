#include "preprocess/read/e57_vector.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::size_t kSpareBytes = 8;
constexpr std::uint64_t kMaxFreePoints = 65536;  // of scans whose points need no bytes at all
constexpr std::size_t kMaxPendingBytes = std::size_t{64} << 20;
constexpr std::uint8_t kIndexPacket = 0, kDataPacket = 1, kIgnoredPacket = 2;

}  // namespace

std::uint64_t E57Vector::Stream::ready() const {
    if (field->bits == 0) return std::numeric_limits<std::uint64_t>::max();
    return (std::uint64_t{used} * 8 - first_bit) / field->bits;
}

void E57Vector::Stream::append(E57Pages& pages, std::uint64_t at, std::size_t count) {
    if (bytes.size() < used + count + kSpareBytes) bytes.resize(used + count + kSpareBytes);
    pages.read(at, bytes.data() + used, count);
    used += count;
}

void E57Vector::Stream::decode(std::size_t count, double* values) {
    const std::uint32_t bits = field->bits;
    if (field->type == E57Field::Type::kFloat) {
        const std::byte* from = bytes.data() + first_bit / 8;
        for (std::size_t i = 0; i < count; ++i) {
            values[i] = static_cast<double>(load<float>(from + 4 * i));
        }
    } else if (field->type == E57Field::Type::kDouble) {
        std::memcpy(values, bytes.data() + first_bit / 8, 8 * count);
    } else {
        const std::uint64_t mask = bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
        const auto minimum = static_cast<std::uint64_t>(field->minimum);
        std::uint64_t bit = first_bit;
        for (std::size_t i = 0; i < count; ++i, bit += bits) {
            std::uint64_t stored = 0;
            if (bits > 0) {
                const std::byte* from = bytes.data() + bit / 8;
                const auto shift = static_cast<std::uint32_t>(bit % 8);
                stored = load<std::uint64_t>(from) >> shift;
                if (bits + shift > 64) {
                    stored |= std::to_integer<std::uint64_t>(from[8]) << (64 - shift);
                }
                stored &= mask;
            }
            values[i] =
                static_cast<double>(static_cast<std::int64_t>(minimum + stored)) * field->scale +
                field->offset;
        }
    }
    first_bit += std::uint64_t{bits} * count;
}

void E57Vector::Stream::drop_decoded() {
    const std::size_t whole = std::min<std::size_t>(first_bit / 8, used);
    if (whole == 0) return;
    std::memmove(bytes.data(), bytes.data() + whole, used - whole);
    used -= whole;
    first_bit -= 8 * std::uint64_t{whole};
}

E57Vector::E57Vector(E57Pages& pages, const E57Scan& scan, std::vector<std::size_t> wanted)
    : pages_(pages), field_count_(scan.fields.size()), left_(scan.record_count) {
    for (const std::size_t number : wanted) {
        streams_.push_back({&scan.fields[number], number, std::vector<std::byte>(kSpareBytes)});
    }
    if (left_ == 0) return;  // the section is not looked at: writers leave anything there

    const InputFile& file = pages.file();
    std::byte head[32];
    pages.read(scan.section, head, sizeof(head));
    const auto length = load<std::uint64_t>(head + 8);
    at_ = e57_logical(load<std::uint64_t>(head + 16));
    if (std::to_integer<int>(head[0]) != 1 || at_ < scan.section + sizeof(head) ||
        length > pages.size() - scan.section || at_ > scan.section + length) {
        file.fail("the header of a scan's points is damaged; copy or export it again");
    }
    end_ = scan.section + length;

    std::uint64_t bits = 0;
    for (const Stream& stream : streams_)
        bits += stream.field->bits;
    const std::uint64_t most = bits == 0 ? kMaxFreePoints : (end_ - at_) * 8 / bits;
    if (left_ > most) {
        file.fail("a scan announces more points than it has bytes for; copy or export it again");
    }
}

std::uint64_t E57Vector::ready() const {
    std::uint64_t least = left_;
    for (const Stream& stream : streams_)
        least = std::min(least, stream.ready());
    return least;
}

bool E57Vector::read_packet() {
    const InputFile& file = pages_.file();
    if (end_ - at_ < 4) return false;
    std::byte head[6];
    pages_.read(at_, head, 4);
    const auto kind = std::to_integer<std::uint8_t>(head[0]);
    const std::uint64_t length = load<std::uint16_t>(head + 2) + std::uint64_t{1};
    if (kind > kIgnoredPacket || length % 4 != 0 || length > end_ - at_) {
        file.fail("a packet of its points is damaged; copy or export it again");
    }
    if (kind == kDataPacket) {
        pages_.read(at_, head, 6);
        const std::size_t count = load<std::uint16_t>(head + 4);
        std::uint64_t from = at_ + 6 + 2 * std::uint64_t{count};
        if (count != field_count_ || from > at_ + length) {
            file.fail("a packet of its points is damaged; copy or export it again");
        }
        std::vector<std::uint16_t> sizes(count);
        pages_.read(at_ + 6, sizes.data(), 2 * count);
        for (std::size_t number = 0; number < count; ++number) {
            if (sizes[number] > at_ + length - from) {
                file.fail("a packet of its points is damaged; copy or export it again");
            }
            for (Stream& stream : streams_) {
                if (stream.number != number || stream.field->bits == 0) continue;
                if (stream.used + sizes[number] > kMaxPendingBytes) {
                    file.fail("the fields of its points are out of step; copy or export it again");
                }
                stream.append(pages_, from, sizes[number]);
            }
            from += sizes[number];
        }
    }
    at_ += length;
    return true;
}

std::size_t E57Vector::read(std::size_t most, std::vector<std::vector<double>>& values) {
    while (ready() < std::min<std::uint64_t>(left_, most)) {
        if (!read_packet()) {
            pages_.file().fail(
                "a scan holds fewer points than it announces; copy or export it again");
        }
    }
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(ready(), most));
    if (count == 0) return 0;
    values.resize(streams_.size());
    for (std::size_t i = 0; i < streams_.size(); ++i) {
        values[i].resize(count);
        streams_[i].decode(count, values[i].data());
        streams_[i].drop_decoded();
    }
    left_ -= count;
    return count;
}

}  // namespace glowworm
