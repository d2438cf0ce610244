#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "preprocess/read/input_file.h"

namespace glowworm {

/// Reads a file front to back through 1 MiB of memory.
class ByteReader {
  public:
    ByteReader(const InputFile& file, std::uint64_t offset) : file_(file), offset_(offset) {}

    std::uint64_t left() const { return file_.size() - std::min(file_.size(), offset_); }

    /// Copies the next `bytes` bytes; throws Error (kUnreadable) where the file ends before.
    void read(void* into, std::size_t bytes) {
        if (bytes >= kBufferBytes) {
            file_.read_exactly(offset_, into, bytes);
        } else {
            if (offset_ < buffer_offset_ || offset_ + bytes > buffer_offset_ + buffer_.size())
                refill();
            if (offset_ + bytes > buffer_offset_ + buffer_.size()) {
                file_.fail("it ends before its header says it does; copy or export it again");
            }
            std::memcpy(into, buffer_.data() + (offset_ - buffer_offset_), bytes);
        }
        offset_ += bytes;
    }

    void skip(std::uint64_t bytes) {
        if (bytes > left()) {
            file_.fail("it ends before its header says it does; copy or export it again");
        }
        offset_ += bytes;
    }

  private:
    static constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

    void refill() {
        buffer_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes, left())));
        buffer_offset_ = offset_;
        buffer_.resize(file_.read_some(offset_, buffer_.data(), buffer_.size()));
    }

    const InputFile& file_;
    std::uint64_t offset_;
    std::vector<std::byte> buffer_;
    std::uint64_t buffer_offset_ = 0;
};

}  // namespace glowworm
