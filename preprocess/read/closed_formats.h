#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace glowworm {

/// A scanner vendor's format that only the vendor's programs read.
struct ClosedFormat {
    std::string_view extension;    ///< lower case, with its dot
    std::string_view what;         ///< "a FARO scan"
    std::string_view export_menu;  ///< program and menu that writes E57
};

/// By the name: none of these vendors publishes what their files begin with. To be asked only for
/// files whose content is not recognised. Null for any other name.
const ClosedFormat* closed_format_of(const std::filesystem::path& path);

/// "it is a FARO scan, a format only its vendor can read; export E57 from SCENE (...)".
std::string how_to_export(const ClosedFormat& format);

}  // namespace glowworm
