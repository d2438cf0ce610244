#include "preprocess/read/closed_formats.h"

#include <fmt/format.h>

#include <system_error>

#include "octree/error.h"

namespace glowworm {
namespace {

constexpr std::string_view kScene =
    "FARO SCENE (right-click the scans, Import/Export > Export Scan, or Export in its menu)";
constexpr std::string_view kLaserControl = "Z+F LaserControl (its export of scans)";
constexpr std::string_view kRiscan = "RIEGL RiSCAN PRO (its export of scan positions)";
constexpr std::string_view kRecap = "Autodesk ReCap Pro (Export, format E57)";
constexpr std::string_view kCyclone = "Leica Cyclone or Cyclone 3DR (its export of point clouds)";
constexpr std::string_view kRealWorks = "Trimble RealWorks (its export of scans)";

constexpr ClosedFormat kClosedFormats[] = {
    {".fls", "a FARO scan", kScene},
    {".fws", "a FARO workspace", kScene},
    {".lsproj", "a FARO project", kScene},
    {".zfs", "a Zoller+Froehlich scan", kLaserControl},
    {".zfprj", "a Zoller+Froehlich project", kLaserControl},
    {".rdb", "a RIEGL point database", kRiscan},
    {".rdbx", "a RIEGL point database", kRiscan},
    {".rxp", "a RIEGL data stream", kRiscan},
    {".rcp", "an Autodesk ReCap project", kRecap},
    {".rcs", "an Autodesk ReCap scan", kRecap},
    {".imp", "a Leica Cyclone database", kCyclone},
    {".lgs", "a Leica LGS project", kCyclone},
    {".lgsx", "a Leica LGSx project", kCyclone},
    {".tzf", "a Trimble scan", kRealWorks},
};

}  // namespace

const ClosedFormat* closed_format_of(const std::filesystem::path& path) {
    // "scan.fls/" names the same folder as "scan.fls".
    const std::filesystem::path named = path.has_filename() ? path : path.parent_path();
    std::string extension = named.extension().string();
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
                       format.what, format.exporter);
}

void refuse_closed_folder(const std::filesystem::path& path) {
    std::error_code ignored;
    const ClosedFormat* closed = closed_format_of(path);
    if (closed == nullptr || !std::filesystem::is_directory(path, ignored)) return;
    throw Error(ExitCode::kUnreadable,
                "cannot read '" + path.string() + "': " + how_to_export(*closed));
}

}  // namespace glowworm
