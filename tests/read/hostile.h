#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <random>
#include <stdexcept>
#include <string>

#include "scan_text.h"

namespace glowworm::testing {

/// A file that lies in memory: damaging one a thousand times on a disk takes minutes.
class MemoryFile {
  public:
    MemoryFile() : descriptor_(::memfd_create("scan", MFD_CLOEXEC)) {}
    ~MemoryFile() { ::close(descriptor_); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    /// The path of a file of this content, until the next call.
    std::filesystem::path of(std::string_view content) {
        if (::ftruncate(descriptor_, 0) != 0 ||
            ::pwrite(descriptor_, content.data(), content.size(), 0) !=
                static_cast<ssize_t>(content.size())) {
            throw std::runtime_error("cannot write to memory");
        }
        return "/proc/self/fd/" + std::to_string(descriptor_);
    }

  private:
    int descriptor_;
};

/// Whether a file of this content is refused.
inline bool is_refused(MemoryFile& file, std::string_view content,
                       const ReadSettings& settings = {}) {
    return outcome_of_reading(file.of(content), settings).code != ExitCode::kDone;
}

/// Reads `content` cut off after every `step` bytes: each must end in an Error or in points, never
/// in anything else. Returns how many of the cut files were refused.
inline std::size_t refused_when_cut(const std::string& content, std::size_t step = 1) {
    MemoryFile file;
    std::size_t refused = 0;
    for (std::size_t bytes = 0; bytes < content.size(); bytes += step) {
        if (is_refused(file, std::string_view(content).substr(0, bytes))) ++refused;
    }
    return refused;
}

/// Reads `content` with each bit in [begin, end) flipped, one at a time; returns how many of the
/// damaged files were refused.
inline std::size_t refused_when_flipped(const std::string& content, std::size_t begin,
                                        std::size_t end, const ReadSettings& settings = {}) {
    MemoryFile file;
    std::size_t refused = 0;
    for (std::size_t at = begin; at < std::min(end, content.size()); ++at) {
        for (int bit = 0; bit < 8; ++bit) {
            std::string damaged = content;
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << bit));
            if (is_refused(file, damaged, settings)) ++refused;
        }
    }
    return refused;
}

/// Reads `content` with a window of 16 random bytes at every `step`; returns how many of the
/// damaged files were refused.
inline std::size_t refused_when_overwritten(const std::string& content, std::size_t step,
                                            const ReadSettings& settings = {}) {
    std::mt19937 random(7);
    MemoryFile file;
    std::size_t refused = 0;
    for (std::size_t at = 0; at + 16 <= content.size(); at += step) {
        std::string damaged = content;
        for (std::size_t i = 0; i < 16; ++i)
            damaged[at + i] = static_cast<char>(random());
        if (is_refused(file, damaged, settings)) ++refused;
    }
    return refused;
}

}  // namespace glowworm::testing
