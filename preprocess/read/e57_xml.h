#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "preprocess/read/input_file.h"

namespace glowworm {

/// An element of an E57 file's XML section.
struct E57Element {
    std::string name;  ///< with its prefix: "nor:normalX"
    std::string text;  ///< its own, without that of its children
    std::vector<std::pair<std::string, std::string>> attributes;
    std::vector<E57Element> children;

    /// The child of this name; null where there is none.
    const E57Element* child(std::string_view child_name) const;

    /// The attribute of this name; empty where there is none.
    std::string_view attribute(std::string_view attribute_name) const;
};

/// The number that is all of `text` but for space around it; nothing where it is none.
std::optional<double> e57_number(std::string_view text);
std::optional<std::int64_t> e57_integer(std::string_view text);
std::optional<std::uint64_t> e57_count(std::string_view text);

/// Parses the XML section of `file`. Throws Error (kUnreadable) for what is not well-formed, has a
/// document type declaration (entities), is nested more than 40 deep or has more than 2^20
/// elements.
E57Element parse_e57_xml(const InputFile& file, std::string_view xml);

}  // namespace glowworm
