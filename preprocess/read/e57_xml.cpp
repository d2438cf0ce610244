#include "preprocess/read/e57_xml.h"

#include <expat.h>
#include <fmt/format.h>

#include <charconv>
#include <memory>

namespace glowworm {
namespace {

constexpr std::size_t kMaxDepth = 40;
constexpr std::size_t kMaxElements = std::size_t{1} << 20;

struct Parse {
    XML_Parser parser = nullptr;
    E57Element document;              // its only child is the root
    std::vector<E57Element*> open{};  // from the document to the innermost element
    std::size_t elements = 0;
    std::string refusal;

    void refuse(const char* reason) {
        if (refusal.empty()) refusal = reason;
        XML_StopParser(parser, XML_FALSE);
    }
};

/// Only what the reader asks for is kept: attributes cost more memory than bytes of the file.
bool is_known(std::string_view attribute) {
    for (const char* known : {"type", "minimum", "maximum", "scale", "offset", "precision",
                              "fileOffset", "recordCount"}) {
        if (attribute == known) return true;
    }
    return false;
}

void start_element(void* data, const XML_Char* name, const XML_Char** attributes) {
    Parse& parse = *static_cast<Parse*>(data);
    if (parse.open.size() > kMaxDepth) return parse.refuse("its XML section is nested too deeply");
    if (++parse.elements > kMaxElements) {
        return parse.refuse("its XML section has too many elements");
    }
    // A child's address holds while it is open: its parent gets no other child before it closes.
    E57Element& element = parse.open.back()->children.emplace_back();
    element.name = name;
    for (; attributes[0] != nullptr; attributes += 2) {
        if (is_known(attributes[0])) element.attributes.emplace_back(attributes[0], attributes[1]);
    }
    parse.open.push_back(&element);
}

void end_element(void* data, const XML_Char*) {
    static_cast<Parse*>(data)->open.pop_back();
}

void add_text(void* data, const XML_Char* text, int length) {
    static_cast<Parse*>(data)->open.back()->text.append(text, static_cast<std::size_t>(length));
}

void start_doctype(void* data, const XML_Char*, const XML_Char*, const XML_Char*, int) {
    static_cast<Parse*>(data)->refuse("its XML section declares a document type");
}

std::string_view trimmed(std::string_view text) {
    const auto is_space = [](char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; };
    while (!text.empty() && is_space(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_space(text.back()))
        text.remove_suffix(1);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    return text;
}

template <typename T>
std::optional<T> number(std::string_view text) {
    text = trimmed(text);
    T value{};
    const auto [stop, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || stop != text.data() + text.size()) return std::nullopt;
    return value;
}

}  // namespace

const E57Element* E57Element::child(std::string_view child_name) const {
    for (const E57Element& candidate : children) {
        if (candidate.name == child_name) return &candidate;
    }
    return nullptr;
}

std::string_view E57Element::attribute(std::string_view attribute_name) const {
    for (const auto& [key, value] : attributes) {
        if (key == attribute_name) return value;
    }
    return {};
}

std::optional<double> e57_number(std::string_view text) {
    return number<double>(text);
}
std::optional<std::int64_t> e57_integer(std::string_view text) {
    return number<std::int64_t>(text);
}
std::optional<std::uint64_t> e57_count(std::string_view text) {
    return number<std::uint64_t>(text);
}

E57Element parse_e57_xml(const InputFile& file, std::string_view xml) {
    const std::unique_ptr<XML_ParserStruct, void (*)(XML_Parser)> parser(XML_ParserCreate(nullptr),
                                                                         XML_ParserFree);
    Parse parse;
    parse.parser = parser.get();
    parse.open = {&parse.document};
    XML_SetUserData(parser.get(), &parse);
    XML_SetElementHandler(parser.get(), start_element, end_element);
    XML_SetCharacterDataHandler(parser.get(), add_text);
    XML_SetStartDoctypeDeclHandler(parser.get(), start_doctype);
    // Some writers count their padding in.
    while (!xml.empty() && (xml.back() == '\0' || xml.back() == ' '))
        xml.remove_suffix(1);
    const bool parsed = XML_Parse(parser.get(), xml.data(), static_cast<int>(xml.size()),
                                  XML_TRUE) == XML_STATUS_OK;
    if (!parse.refusal.empty())
        file.fail(parse.refusal + "; export it again from the scanner's program");
    if (!parsed) {
        file.fail(fmt::format("its XML section is damaged in line {} ({}); copy or export it again",
                              XML_GetCurrentLineNumber(parser.get()),
                              XML_ErrorString(XML_GetErrorCode(parser.get()))));
    }
    return std::move(parse.document.children.front());
}

}  // namespace glowworm
