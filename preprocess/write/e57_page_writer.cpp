#include "preprocess/write/e57_page_writer.h"

#include <algorithm>

#include "preprocess/read/crc32c.h"
#include "preprocess/read/e57_pages.h"

namespace glowworm {

void E57PageWriter::write(const void* data, std::size_t bytes) {
    const auto* next = static_cast<const std::byte*>(data);
    logical_ += bytes;
    while (bytes > 0) {
        const std::size_t part = std::min<std::size_t>(bytes, kE57PayloadBytes - page_.size());
        page_.insert(page_.end(), next, next + part);
        next += part;
        bytes -= part;
        if (page_.size() == kE57PayloadBytes) end_page();
    }
}

void E57PageWriter::finish() {
    if (page_.empty()) return;
    page_.resize(kE57PayloadBytes);
    end_page();
}

void E57PageWriter::end_page() {
    const std::uint32_t crc = crc32c(page_);
    for (int shift = 24; shift >= 0; shift -= 8) {
        page_.push_back(static_cast<std::byte>(crc >> shift));
    }
    file_.write(page_.data(), page_.size());
    page_.clear();
}

}  // namespace glowworm
