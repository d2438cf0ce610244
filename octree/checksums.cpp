#include "octree/checksums.h"

#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <algorithm>
#include <memory>
#include <new>
#include <string>

namespace glowworm {
namespace {

const char* name_of(std::uint32_t kind) {
    constexpr const char* kNames[] = {"levels", "nodes",      "attributes", "lobes",
                                      "chunks", "points",     "stations",   "area lights",
                                      "names",  "provenance", "links"};
    return kind >= 1 && kind <= std::size(kNames) ? kNames[kind - 1] : "an unknown section";
}

bool is_wanted(std::uint32_t kind, std::initializer_list<SectionKind> kinds) {
    return kinds.size() == 0 ||
           std::ranges::find(kinds, static_cast<SectionKind>(kind)) != kinds.end();
}

void check_padding(const OctreeFile& file, Sentences& sentences) {
    const std::span<const char> bytes = file.contents();
    std::uint64_t end = sizeof(FileHeader);
    for (std::uint32_t i = 0; i < file.header().section_count; ++i) {
        const SectionEntry& s = file.header().sections[i];
        const auto padding = bytes.subspan(end, s.offset - end);
        if (!std::ranges::all_of(padding, [](char b) { return b == 0; })) {
            sentences.push_back("the padding before section kind " + std::to_string(s.kind) +
                                " is not zero");
        }
        end = s.offset + s.count * s.record_bytes;
    }
    if (end != bytes.size()) {
        sentences.push_back(std::to_string(bytes.size() - end) + " bytes follow the last section");
    }
}

/// In pieces, between which it can be stopped.
XXH64_hash_t hash_of(std::span<const char> bytes, const std::stop_token& stop) {
    constexpr std::size_t kPiece = std::size_t{16} << 20;
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                         &XXH3_freeState);
    if (!state) throw std::bad_alloc();
    XXH3_64bits_reset(state.get());
    while (!bytes.empty() && !stop.stop_requested()) {
        const auto piece = bytes.first(std::min(kPiece, bytes.size()));
        XXH3_64bits_update(state.get(), piece.data(), piece.size());
        bytes = bytes.subspan(piece.size());
    }
    return XXH3_64bits_digest(state.get());
}

}  // namespace

Sentences check_checksums(const OctreeFile& file, std::initializer_list<SectionKind> kinds,
                          const std::stop_token& stop) {
    const FileHeader& header = file.header();
    std::vector<std::uint8_t> wrong(header.section_count, 0);
    tbb::parallel_for(std::uint32_t{0}, header.section_count, [&](std::uint32_t i) {
        const SectionEntry& s = header.sections[i];
        if (!is_wanted(s.kind, kinds)) return;
        const auto bytes = file.contents().subspan(s.offset, s.count * s.record_bytes);
        wrong[i] = hash_of(bytes, stop) != s.checksum;
    });
    if (stop.stop_requested()) return {};
    Sentences sentences;
    for (std::uint32_t i = 0; i < header.section_count; ++i) {
        if (!wrong[i]) continue;
        sentences.push_back("section kind " + std::to_string(header.sections[i].kind) + " (" +
                            name_of(header.sections[i].kind) + ") does not match its checksum");
    }
    if (kinds.size() == 0) check_padding(file, sentences);
    return sentences;
}

}  // namespace glowworm
