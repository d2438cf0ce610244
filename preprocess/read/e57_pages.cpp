#include "preprocess/read/e57_pages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "preprocess/read/crc32c.h"

namespace glowworm {
namespace {

constexpr std::size_t kBufferPages = 256;

std::uint32_t big_endian(const std::byte* at) {
    std::uint32_t value = 0;
    for (int i = 0; i < 4; ++i)
        value = value << 8 | std::to_integer<std::uint32_t>(at[i]);
    return value;
}

}  // namespace

void E57Pages::load(std::uint64_t page) {
    buffer_.resize(kBufferPages * kE57PageBytes);
    const std::size_t bytes = file_.read_some(page * kE57PageBytes, buffer_.data(), buffer_.size());
    std::size_t kept = 0;
    for (std::size_t at = 0; at < bytes; at += kE57PageBytes) {
        const std::byte* payload = buffer_.data() + at;
        const std::size_t there = bytes - at;
        if (check_crc_) {
            if (there < kE57PageBytes) {
                file_.fail(
                    "it ends within a page; copy it again, or read what is there with --no-crc");
            }
            if (crc32c({payload, kE57PayloadBytes}) != big_endian(payload + kE57PayloadBytes)) {
                file_.fail(
                    fmt::format("the checksum of its page {} is wrong; copy it again, or read "
                                "it all the same with --no-crc",
                                page + at / kE57PageBytes));
            }
        }
        const std::size_t length = std::min<std::size_t>(there, kE57PayloadBytes);
        std::memmove(buffer_.data() + kept, payload, length);
        kept += length;
    }
    begin_ = page * kE57PayloadBytes;
    end_ = begin_ + kept;
}

void E57Pages::read(std::uint64_t logical, void* into, std::size_t bytes) {
    auto* out = static_cast<std::byte*>(into);
    while (bytes > 0) {
        if (logical < begin_ || logical >= end_) {
            if (logical < size()) load(logical / kE57PayloadBytes);
            if (logical < begin_ || logical >= end_) {
                file_.fail("it ends before its header says it does; copy or export it again");
            }
        }
        const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(bytes, end_ - logical));
        std::memcpy(out, buffer_.data() + (logical - begin_), part);
        out += part;
        logical += part;
        bytes -= part;
    }
}

}  // namespace glowworm
