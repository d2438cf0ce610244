#include "preprocess/pipeline/archive.h"

#include <algorithm>

namespace glowworm {
namespace {

constexpr std::string_view kMagic = "glowworm checkpoint 1\n";
constexpr std::size_t kHashDigits = 32;
constexpr std::size_t kLongestRead = std::size_t{1} << 20;  // bytes between which a signal is heard
constexpr std::size_t kMostWaiting = 65536;                 // bytes

}  // namespace

ArchiveWriter::ArchiveWriter(const std::filesystem::path& path, const std::string& key)
    : file_(path) {
    put(kMagic.data(), kMagic.size());
    (*this)(key);
}

void ArchiveWriter::put(const void* data, std::size_t bytes) {
    if (bytes == 0) return;
    hash_.bytes(data, bytes);
    if (waiting_.size() + bytes > kMostWaiting) flush();
    if (bytes > kMostWaiting) {
        file_.write(data, bytes);
    } else {
        waiting_.append(static_cast<const char*>(data), bytes);
    }
}

void ArchiveWriter::flush() {
    file_.write(waiting_);
    waiting_.clear();
}

void ArchiveWriter::operator()(const std::string& text) {
    (*this)(static_cast<std::uint64_t>(text.size()));
    put(text.data(), text.size());
}

void ArchiveWriter::commit() {
    flush();
    file_.write(hash_.hex());
    // Not synced: what a power cut left of it has another hash and is as good as none.
    file_.commit(false);
}

ArchiveReader::ArchiveReader(const std::filesystem::path& path, const std::string& key)
    : stream_(path, std::ios::binary) {
    std::error_code failed;
    const std::uintmax_t size = std::filesystem::file_size(path, failed);
    if (!stream_ || failed || size < kHashDigits) return;
    left_ = size - kHashDigits;
    good_ = true;
    std::string magic(kMagic.size(), '\0'), found;
    take(magic.data(), magic.size());
    (*this)(found);
    good_ = good_ && magic == kMagic && (key.empty() || found == key) && is_whole();
}

/// Whether the hash at the end is that of all before it. Reading goes on where it was.
bool ArchiveReader::is_whole() {
    const std::streampos here = stream_.tellg();
    std::uint64_t left = left_ + static_cast<std::uint64_t>(here);
    stream_.seekg(0);
    Hash hash;
    std::vector<char> block(std::size_t{1} << 20);
    while (left > 0 && stream_) {
        const std::size_t bytes = std::min<std::uint64_t>(left, block.size());
        stream_.read(block.data(), static_cast<std::streamsize>(bytes));
        hash.bytes(block.data(), bytes);
        left -= bytes;
    }
    std::string digits(kHashDigits, '\0');
    stream_.read(digits.data(), kHashDigits);
    if (!stream_ || digits != hash.hex()) return false;
    stream_.seekg(here);
    return true;
}

void ArchiveReader::take(void* data, std::size_t bytes) {
    if (bytes > left_) good_ = false;
    if (!good_ || bytes == 0) return;
    left_ -= bytes;
    for (char* next = static_cast<char*>(data); bytes > 0 && stream_;) {
        const std::size_t some = std::min(bytes, kLongestRead);
        stream_.read(next, static_cast<std::streamsize>(some));
        next += some;
        bytes -= some;
    }
    if (!stream_) good_ = false;
}

void ArchiveReader::operator()(std::string& text) {
    std::uint64_t size = 0;
    (*this)(size);
    if (size > left_) good_ = false;
    if (!good_) return;
    text.resize(size);
    take(text.data(), text.size());
}

}  // namespace glowworm
