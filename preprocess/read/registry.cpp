#include "preprocess/read/registry.h"

#include <string>
#include <utility>
#include <vector>

#include "octree/error.h"
#include "preprocess/read/closed_formats.h"
#include "preprocess/read/e57.h"
#include "preprocess/read/las.h"
#include "preprocess/read/pcd.h"
#include "preprocess/read/ply.h"
#include "preprocess/read/ptx.h"
#include "preprocess/read/text_table.h"

namespace glowworm {
namespace {

constexpr ScanFormat kFormats[] = {
    {"E57", is_e57, open_e57},
    {"LAS", is_las, open_las},
    {"PLY", is_ply, open_ply},
    {"PCD", is_pcd, open_pcd},
    {"PTX", is_ptx, open_ptx},
    {"PTS", is_pts, open_pts},
    {"XYZ text", is_text_table, open_text_table},
};

std::vector<std::byte> head_of(const InputFile& file) {
    std::vector<std::byte> head(kHeadBytes);
    head.resize(file.read_some(0, head.data(), head.size()));
    return head;
}

/// What packed a file, by its first bytes; empty where nothing did.
std::string_view packer_of(std::span<const std::byte> head) {
    constexpr std::pair<std::string_view, std::string_view> kPackers[] = {
        {"\x1f\x8b", "gzip"},
        {"PK\x03\x04", "zip"},
        {"7z\xbc\xaf", "7-Zip"},
        {"BZh", "bzip2"},
        {"\xfd"
         "7zXZ",
         "xz"},
        {"\x28\xb5\x2f\xfd", "Zstandard"},
        {"Rar!", "RAR"},
    };
    const std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    for (const auto& [magic, name] : kPackers) {
        if (text.starts_with(magic)) return name;
    }
    return {};
}

std::string format_names() {
    std::string names;
    for (const ScanFormat& format : kFormats) {
        if (!names.empty()) names += ", ";
        names += format.name;
    }
    return names;
}

}  // namespace

std::span<const ScanFormat> scan_formats() {
    return kFormats;
}

const ScanFormat* recognise_format(std::span<const std::byte> head) {
    for (const ScanFormat& format : kFormats) {
        if (format.recognises(head)) return &format;
    }
    return nullptr;
}

const ScanFormat* recognise_format(const std::filesystem::path& path) {
    try {
        return recognise_format(head_of(InputFile(path)));
    } catch (const Error&) {
        return nullptr;
    }
}

std::unique_ptr<ScanFile> open_scan_file(const std::filesystem::path& path,
                                         const ReadSettings& settings) {
    refuse_closed_folder(path);
    InputFile file(path);
    const std::vector<std::byte> head = head_of(file);
    if (const ScanFormat* format = recognise_format(head)) {
        return format->open(std::move(file), settings);
    }
    if (const ClosedFormat* closed = closed_format_of(path)) file.fail(how_to_export(*closed));
    if (const std::string_view packer = packer_of(head); !packer.empty()) {
        file.fail("it is packed by " + std::string(packer) + "; unpack it and name what was in it");
    }
    const bool as_table = !settings.columns.empty() || settings.delimiter != '\0';
    if (as_table) return open_text_table(std::move(file), settings);
    if (const std::string why = why_no_text_table(head); !why.empty()) file.fail(why);
    file.fail("it is of no kind Glowworm knows (" + format_names() +
              "); export the scan as E57, LAS, PLY or PCD");
}

}  // namespace glowworm
