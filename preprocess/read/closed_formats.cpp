#include "preprocess/read/closed_formats.h"

#include <fmt/format.h>

namespace glowworm {
namespace {

constexpr ClosedFormat kClosedFormats[] = {
    {".fls", "a FARO scan", "FARO SCENE (menu Export, format E57)"},
    {".fws", "a FARO workspace", "FARO SCENE (menu Export, format E57)"},
    {".lsproj", "a FARO project", "FARO SCENE (menu Export, format E57)"},
    {".zfs", "a Zoller+Froehlich scan", "Z+F LaserControl (menu File > Export, format E57)"},
    {".zfprj", "a Zoller+Froehlich project", "Z+F LaserControl (menu File > Export, format E57)"},
    {".rdb", "a RIEGL point database", "RiSCAN PRO (menu Export, format E57)"},
    {".rdbx", "a RIEGL point database", "RiSCAN PRO (menu Export, format E57)"},
    {".rxp", "a RIEGL data stream", "RiSCAN PRO (menu Export, format E57)"},
    {".rcp", "an Autodesk ReCap project", "ReCap Pro (menu Export, format E57)"},
    {".rcs", "an Autodesk ReCap scan", "ReCap Pro (menu Export, format E57)"},
};

}  // namespace

const ClosedFormat* closed_format_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    for (char& c : extension) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    for (const ClosedFormat& format : kClosedFormats) {
        if (format.extension == extension) return &format;
    }
    return nullptr;
}

std::string how_to_export(const ClosedFormat& format) {
    return fmt::format("it is {}, a format only its vendor's programs read; export E57 from {}",
                       format.what, format.export_menu);
}

}  // namespace glowworm
