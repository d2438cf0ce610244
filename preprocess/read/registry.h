#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>

#include "preprocess/read/input_file.h"
#include "preprocess/read/scan_file.h"

namespace glowworm {

/// How many bytes of a file `recognises` gets to see, fewer where the file is shorter.
inline constexpr std::size_t kHeadBytes = 65536;

/// A format that we read. To add one, add its row to the table in registry.cpp.
struct ScanFormat {
    std::string_view name;                                ///< "PLY"
    bool (*recognises)(std::span<const std::byte> head);  ///< by the file's first bytes
    std::unique_ptr<ScanFile> (*open)(InputFile file, const ReadSettings& settings);
};

/// In the order in which they are asked: those with a magic number before tables of text.
std::span<const ScanFormat> scan_formats();

/// The format of a file's first bytes; null where none recognises them.
const ScanFormat* recognise_format(std::span<const std::byte> head);

/// As above; null too where the path cannot be read as a file.
const ScanFormat* recognise_format(const std::filesystem::path& path);

}  // namespace glowworm
