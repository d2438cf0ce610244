#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "preprocess/read/input_file.h"

namespace glowworm {

inline constexpr std::uint64_t kE57PageBytes = 1024;     ///< as it lies in the file
inline constexpr std::uint64_t kE57PayloadBytes = 1020;  ///< of that, before the page's CRC-32C

/// Offset without the checksums that lie before it; offsets in an E57 file count them (ASTM
/// E2807-11, 7.2).
constexpr std::uint64_t e57_logical(std::uint64_t physical) {
    const std::uint64_t in_page = physical % kE57PageBytes;
    return physical / kE57PageBytes * kE57PayloadBytes +
           (in_page < kE57PayloadBytes ? in_page : kE57PayloadBytes);
}

constexpr std::uint64_t e57_physical(std::uint64_t logical) {
    return logical / kE57PayloadBytes * kE57PageBytes + logical % kE57PayloadBytes;
}

/// The content of a paged file without its checksums, which are verified page by page on the way.
class E57Pages {
  public:
    E57Pages(const InputFile& file, bool check_crc) : file_(file), check_crc_(check_crc) {}

    const InputFile& file() const { return file_; }
    std::uint64_t size() const { return e57_logical(file_.size()); }  ///< logical bytes

    /// Copies `bytes` bytes from a logical offset on. Throws Error (kUnreadable) where the file
    /// ends before or a checksum is wrong.
    void read(std::uint64_t logical, void* into, std::size_t bytes);

  private:
    void load(std::uint64_t page);

    const InputFile& file_;
    bool check_crc_;
    std::vector<std::byte> buffer_;      // payloads of consecutive pages
    std::uint64_t begin_ = 0, end_ = 0;  // logical bytes in the buffer
};

}  // namespace glowworm
