#include "preprocess/read/line_reader.h"

#include <algorithm>
#include <cstring>

namespace glowworm {
namespace {

constexpr std::size_t kBufferBytes = std::size_t{1} << 20;

}  // namespace

TextEncoding text_encoding(std::string_view head, std::size_t& mark_bytes) {
    mark_bytes = head.starts_with("\xef\xbb\xbf") ? 3 : 0;
    if (!head.starts_with("\xff\xfe") && !head.starts_with("\xfe\xff")) return TextEncoding::kUtf8;
    mark_bytes = 2;
    return head[0] == '\xff' ? TextEncoding::kUtf16Little : TextEncoding::kUtf16Big;
}

void append_utf16(std::string_view bytes, TextEncoding encoding, std::vector<char>& text) {
    const std::size_t low = encoding == TextEncoding::kUtf16Little ? 0 : 1;
    for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
        const char character = bytes[i + low];
        text.push_back(bytes[i + 1 - low] == 0 && character >= 0 ? character : '?');
    }
}

LineReader::LineReader(const InputFile& file, std::uint64_t offset)
    // A byte more than a small file has, so that only a line too long fills the buffer.
    : file_(file),
      buffer_(static_cast<std::size_t>(std::min<std::uint64_t>(kBufferBytes, file.size() + 1))),
      buffer_offset_(offset) {
    if (offset == 0) {
        char mark[3] = {};
        const std::size_t got = file.read_some(0, mark, sizeof mark);
        std::size_t mark_bytes = 0;
        encoding_ = text_encoding({mark, got}, mark_bytes);
        buffer_offset_ = raw_offset_ = mark_bytes;
    }
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
    if (encoding_ != TextEncoding::kUtf8) return refill_utf16();
    const std::size_t got =
        file_.read_some(buffer_offset_ + end_, buffer_.data() + end_, buffer_.size() - end_);
    end_ += got;
    return got > 0;
}

bool LineReader::refill_utf16() {
    std::vector<char> raw((buffer_.size() - end_) * 2);
    raw.resize(file_.read_some(raw_offset_, raw.data(), raw.size()));
    raw_offset_ += raw.size();
    std::vector<char> text;
    append_utf16({raw.data(), raw.size()}, encoding_, text);
    std::copy(text.begin(), text.end(), buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
    end_ += text.size();
    return !text.empty();
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
    ++line_number_;
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
