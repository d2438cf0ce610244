#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace glowworm {

/// A scanner vendor's format that only the vendor's programs read.
struct ClosedFormat {
    std::string_view extension;  ///< lower case, with its dot
    std::string_view what;       ///< "a FARO scan"
    std::string_view exporter;   ///< program that writes E57, and where in it where that is known
};

/// By the name: none of these vendors publishes what their files begin with. To be asked only for
/// files whose content is not recognised. Null for any other name.
const ClosedFormat* closed_format_of(const std::filesystem::path& path);

/// "it is a FARO scan, a format only its vendor's programs read; export E57 from FARO SCENE (...)".
std::string how_to_export(const ClosedFormat& format);

/// FARO's scanners write a scan or a project as a folder named like a file. Throws Error
/// (kUnreadable) with how_to_export for such a folder; nothing for anything else.
void refuse_closed_folder(const std::filesystem::path& path);

}  // namespace glowworm
