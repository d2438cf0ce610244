#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

#include "preprocess/read/input_file.h"

namespace glowworm {

/// How the characters of a text file are stored, as its first bytes say.
enum class TextEncoding { kUtf8, kUtf16Little, kUtf16Big };

/// By the byte-order mark; kUtf8 without one. `mark_bytes` is how long the mark is.
TextEncoding text_encoding(std::string_view head, std::size_t& mark_bytes);

/// Appends `bytes` of UTF-16 to `text`, '?' for what is not ASCII: enough for numbers and names of
/// columns. An odd last byte is left out.
void append_utf16(std::string_view bytes, TextEncoding encoding, std::vector<char>& text);

/// The lines of a file, from 1 MiB of memory. Ends of lines are \n, \r\n, or \r where no \n follows
/// the first \r. A byte-order mark is passed over and UTF-16 read as ASCII. A longer line throws
/// Error (kUnreadable).
class LineReader {
  public:
    explicit LineReader(const InputFile& file, std::uint64_t offset = 0);

    /// The next line without its end, valid until the next call. False at the end of the file.
    bool next(std::string_view& line);

    /// Byte offset in the file of the line that comes next; of no use in UTF-16.
    std::uint64_t offset() const { return buffer_offset_ + begin_; }

    /// Number of the line that was last handed out, counted from 1.
    std::uint64_t line_number() const { return line_number_; }

  private:
    bool refill();
    bool refill_utf16();

    const InputFile& file_;
    std::vector<char> buffer_;
    std::uint64_t buffer_offset_ = 0;  // of buffer_[0] in the file
    std::size_t begin_ = 0, end_ = 0;  // what is left of the buffer
    std::uint64_t line_number_ = 0;
    char terminator_ = '\n';
    TextEncoding encoding_ = TextEncoding::kUtf8;
    std::uint64_t raw_offset_ = 0;  // UTF-16: of the next byte to read
};

/// Takes the next word off `line`, words being parted by any number of `separators`; empty where
/// there is none.
std::string_view take_word(std::string_view& line, const char* separators = " \t");

/// Parses the number at the front of [at, end) whatever the locale; returns where it ends, `at`
/// where there is none. Too large is infinity, too small is zero.
inline const char* parse_number(const char* at, const char* end, double& value) {
    const char* begin = at < end && *at == '+' ? at + 1 : at;
    const auto [stop, problem] = std::from_chars(begin, end, value);
    if (problem == std::errc::invalid_argument) return at;
    if (problem == std::errc::result_out_of_range) {
        const bool tiny = std::string_view(begin, stop).find("e-") != std::string_view::npos ||
                          std::string_view(begin, stop).find("E-") != std::string_view::npos;
        value =
            tiny ? 0.0
                 : std::copysign(std::numeric_limits<double>::infinity(), *begin == '-' ? -1 : 1);
    }
    return stop;
}

/// Whether all of `word` is a number.
inline bool parse_number(std::string_view word, double& value) {
    const char* end = word.data() + word.size();
    return !word.empty() && parse_number(word.data(), end, value) == end;
}

/// Whether all of `word` is a count.
inline bool parse_count(std::string_view word, std::uint64_t& value) {
    const char* end = word.data() + word.size();
    const auto [stop, problem] = std::from_chars(word.data(), end, value);
    return !word.empty() && problem == std::errc() && stop == end;
}

}  // namespace glowworm
