#include "preprocess/read/lzf.h"

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace glowworm {
namespace {

// A control byte below 32 begins a run of 1..32 literal bytes. Otherwise its high 3 bits are the
// length of a reference minus 2, where 7 says that the next byte adds to it, and its low 5 bits
// are the high part of the distance minus 1, whose low part is the byte after that.
constexpr std::size_t kLongestRun = 32;
constexpr std::size_t kLongestReference = 264;
constexpr std::size_t kFarthest = 8192;
constexpr std::size_t kHashBits = 14;

std::size_t hash_of(const std::byte* at) {
    const std::uint32_t three = static_cast<std::uint32_t>(at[0]) << 16 |
                                static_cast<std::uint32_t>(at[1]) << 8 |
                                static_cast<std::uint32_t>(at[2]);
    return (three * 2654435761u) >> (32 - kHashBits);
}

}  // namespace

bool decode_lzf(std::span<const std::byte> input, std::span<std::byte> output) {
    std::size_t in = 0, out = 0;
    while (in < input.size()) {
        const auto control = static_cast<std::size_t>(input[in++]);
        if (control < 32) {
            const std::size_t run = control + 1;
            if (run > input.size() - in || run > output.size() - out) return false;
            std::memcpy(&output[out], &input[in], run);
            in += run;
            out += run;
            continue;
        }
        std::size_t length = control >> 5;
        if (length == 7) {
            if (in == input.size()) return false;
            length += static_cast<std::size_t>(input[in++]);
        }
        length += 2;
        if (in == input.size()) return false;
        const std::size_t distance =
            ((control & 31) << 8) + static_cast<std::size_t>(input[in++]) + 1;
        if (distance > out || length > output.size() - out) return false;
        std::byte* to = &output[out];
        if (distance >= length) {
            std::memcpy(to, to - distance, length);
        } else {
            for (std::size_t i = 0; i < length; ++i)
                to[i] = to[i - distance];  // it repeats itself
        }
        out += length;
    }
    return out == output.size();
}

std::vector<std::byte> encode_lzf(std::span<const std::byte> input) {
    std::vector<std::byte> output;
    output.reserve(input.size() + input.size() / kLongestRun + 1);
    std::vector<std::size_t> last_seen(std::size_t{1} << kHashBits, 0);  // position + 1
    std::size_t literal_begin = 0;

    const auto write_literals = [&](std::size_t end) {
        while (literal_begin < end) {
            const std::size_t run = std::min(kLongestRun, end - literal_begin);
            output.push_back(static_cast<std::byte>(run - 1));
            const auto from = input.begin() + static_cast<std::ptrdiff_t>(literal_begin);
            output.insert(output.end(), from, from + static_cast<std::ptrdiff_t>(run));
            literal_begin += run;
        }
    };

    std::size_t at = 0;
    while (at + 3 <= input.size()) {
        std::size_t& seen = last_seen[hash_of(&input[at])];
        const std::size_t candidate = seen;
        seen = at + 1;
        if (candidate == 0 || at - (candidate - 1) > kFarthest ||
            std::memcmp(&input[candidate - 1], &input[at], 3) != 0) {
            ++at;
            continue;
        }
        const std::size_t from = candidate - 1;
        const std::size_t most = std::min(kLongestReference, input.size() - at);
        std::size_t length = 3;
        while (length < most && input[from + length] == input[at + length])
            ++length;
        write_literals(at);
        const std::size_t distance = at - from - 1, code = length - 2;
        output.push_back(
            static_cast<std::byte>(std::min<std::size_t>(code, 7) << 5 | distance >> 8));
        if (code >= 7) output.push_back(static_cast<std::byte>(code - 7));
        output.push_back(static_cast<std::byte>(distance & 255));
        at += length;
        literal_begin = at;
    }
    write_literals(input.size());
    return output;
}

}  // namespace glowworm
