#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "preprocess/read/crc32c.h"

// E57 files made byte by byte, so that a test knows what is in them without our writer.

namespace glowworm::testing {

/// Appends numbers bit by bit, the lowest first, as E57 packs integers.
class BitString {
  public:
    void add(std::uint64_t value, int bits) {
        for (int bit = 0; bit < bits; ++bit, ++count_) {
            if (count_ % 8 == 0) bytes_.push_back('\0');
            if ((value >> bit) & 1) {
                bytes_.back() = static_cast<char>(bytes_.back() | 1 << (count_ % 8));
            }
        }
    }
    const std::string& bytes() const { return bytes_; }

  private:
    std::string bytes_;
    std::size_t count_ = 0;
};

template <typename T>
void append(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

/// A data packet with a stream of bytes per field.
inline std::string e57_packet(const std::vector<std::string>& streams) {
    std::string content;
    for (const std::string& stream : streams) {
        append(content, static_cast<std::uint16_t>(stream.size()));
    }
    for (const std::string& stream : streams)
        content += stream;
    while ((content.size() + 6) % 4 != 0)
        content += '\0';
    std::string packet("\1\0", 2);
    append(packet, static_cast<std::uint16_t>(content.size() + 5));
    append(packet, static_cast<std::uint16_t>(streams.size()));
    return packet + content;
}

inline std::uint64_t paged(std::uint64_t logical) {
    return logical / 1020 * 1024 + logical % 1020;
}

/// A section of points at logical offset `at`, its packets as they are.
inline std::string e57_section(std::uint64_t at, const std::string& packets) {
    std::string section("\1\0\0\0\0\0\0\0", 8);
    append(section, std::uint64_t{32 + packets.size()});
    append(section, paged(at + 32));
    append(section, std::uint64_t{0});
    return section + packets;
}

/// Cuts `logical` into pages with their checksums.
inline std::string e57_pages(std::string logical) {
    while (logical.size() % 1020 != 0)
        logical += '\0';
    std::string file;
    for (std::size_t at = 0; at < logical.size(); at += 1020) {
        file.append(logical, at, 1020);
        const std::uint32_t crc = crc32c({reinterpret_cast<const std::byte*>(&logical[at]), 1020});
        for (int shift = 24; shift >= 0; shift -= 8)
            file += static_cast<char>(crc >> shift);
    }
    return file;
}

/// A whole file: header, `sections` (which begin at logical offset 48), XML.
inline std::string e57_file(const std::string& sections, const std::string& xml) {
    const std::size_t xml_at = 48 + sections.size();
    const std::size_t pages = (xml_at + xml.size() + 1019) / 1020;
    std::string file = "ASTM-E57";
    append(file, std::uint32_t{1});
    append(file, std::uint32_t{0});
    append(file, std::uint64_t{pages * 1024});
    append(file, paged(xml_at));
    append(file, std::uint64_t{xml.size()});
    append(file, std::uint64_t{1024});
    return e57_pages(file + sections + xml);
}

/// The XML of one scan. `more` goes beside the points: pose, limits, name.
inline std::string e57_scan_xml(const std::string& fields, std::uint64_t count,
                                const std::string& more = {}, std::uint64_t at = 48) {
    return "<vectorChild type=\"Structure\">" + more +
           "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(paged(at)) +
           "\" recordCount=\"" + std::to_string(count) + "\"><prototype type=\"Structure\">" +
           fields + "</prototype><codecs type=\"Vector\"/></points></vectorChild>";
}

inline std::string e57_xml(const std::string& scans) {
    return "<?xml version=\"1.0\" encoding=\"UTF-8\"?><e57Root type=\"Structure\" "
           "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
           "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\">"
           "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">" +
           scans + "</data3D></e57Root>";
}

/// A file of one scan whose packets are `packets`.
inline std::string e57_of(const std::string& fields, std::uint64_t count,
                          const std::vector<std::string>& packets, const std::string& more = {}) {
    std::string all;
    for (const std::string& packet : packets)
        all += packet;
    return e57_file(e57_section(48, all), e57_xml(e57_scan_xml(fields, count, more)));
}

}  // namespace glowworm::testing
