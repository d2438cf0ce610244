#include "preprocess/read/line_reader.h"

#include <algorithm>
#include <cstring>

namespace glowworm {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

}  // namespace

LineReader::LineReader(const InputFile& file, std::uint64_t offset)
    : file_(file), buffer_(kBufferBytes), buffer_offset_(offset) {
    refill();
    const std::string_view text(buffer_.data(), end_);
    const std::size_t end_of_line = text.find_first_of("\r\n");
    if (end_of_line < text.size() && text[end_of_line] == '\r' &&
        (end_of_line + 1 == text.size() || text[end_of_line + 1] != '\n')) {
        terminator_ = '\r';
    }
}

bool LineReader::refill() {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    buffer_offset_ += begin_;
    end_ -= begin_;
    begin_ = 0;
    const std::size_t got =
        file_.read_some(buffer_offset_ + end_, buffer_.data() + end_, buffer_.size() - end_);
    end_ += got;
    return got > 0;
}

bool LineReader::next(std::string_view& line) {
    while (true) {
        const char* from = buffer_.data() + begin_;
        const void* found = end_ > begin_ ? std::memchr(from, terminator_, end_ - begin_) : nullptr;
        if (found != nullptr) {
            line = {from, static_cast<std::size_t>(static_cast<const char*>(found) - from)};
            begin_ += line.size() + 1;
            break;
        }
        if (end_ - begin_ == buffer_.size()) {
            file_.fail("it has a line of more than a megabyte; it is no table of points");
        }
        if (refill()) continue;
        if (begin_ == end_) return false;
        line = {buffer_.data(), end_};
        begin_ = end_;
        break;
    }
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return true;
}

std::string_view take_word(std::string_view& line, const char* separators) {
    const std::size_t begin = line.find_first_not_of(separators);
    if (begin == std::string_view::npos) {
        line = {};
        return {};
    }
    const std::size_t end = std::min(line.find_first_of(separators, begin), line.size());
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

}  // namespace glowworm
