#include "preprocess/read/e57_header.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <limits>

#include "preprocess/read/e57_xml.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kMaxXmlBytes = std::uint64_t{1} << 25;

/// Where something is said in a scan's element, for sentences.
struct Place {
    const InputFile& file;
    std::size_t scan;

    [[noreturn]] void fail(const std::string& what) const {
        file.fail(fmt::format("{} of its scan {} is damaged; export it again", what, scan + 1));
    }
};

double number_in(const E57Element& parent, std::string_view name, double missing) {
    const E57Element* element = parent.child(name);
    if (element == nullptr) return missing;
    const double value = e57_number(element->text).value_or(0.0);  // an empty element is zero
    if (element->attribute("type") != "ScaledInteger") return value;
    return value * e57_number(element->attribute("scale")).value_or(1.0) +
           e57_number(element->attribute("offset")).value_or(0.0);
}

std::string text_in(const E57Element& parent, std::string_view name) {
    const E57Element* element = parent.child(name);
    return element == nullptr ? std::string() : element->text;
}

std::int64_t integer_attribute(const E57Element& element, const char* name, std::int64_t missing,
                               const Place& place) {
    const std::string_view text = element.attribute(name);
    if (text.empty()) return missing;
    const std::optional<std::int64_t> value = e57_integer(text);
    if (!value) place.fail("the range of a field");
    return *value;
}

double number_attribute(const E57Element& element, const char* name, double missing,
                        const Place& place) {
    const std::string_view text = element.attribute(name);
    if (text.empty()) return missing;
    const std::optional<double> value = e57_number(text);
    if (!value || !std::isfinite(*value)) place.fail("the scale of a field");
    return *value;
}

/// Appends the fields below `parent`; structures among them only group.
void read_fields(const E57Element& parent, const Place& place, std::vector<E57Field>& fields) {
    for (const E57Element& element : parent.children) {
        const std::string_view type = element.attribute("type");
        E57Field field;
        field.name = element.name;
        if (type == "Structure") {
            read_fields(element, place, fields);
            continue;
        }
        if (type == "Float") {
            const bool single = element.attribute("precision") == "single";
            field.type = single ? E57Field::Type::kFloat : E57Field::Type::kDouble;
            field.bits = single ? 32 : 64;
        } else if (type == "Integer" || type == "ScaledInteger") {
            field.type =
                type == "Integer" ? E57Field::Type::kInteger : E57Field::Type::kScaledInteger;
            field.minimum = integer_attribute(element, "minimum",
                                              std::numeric_limits<std::int64_t>::min(), place);
            field.maximum = integer_attribute(element, "maximum",
                                              std::numeric_limits<std::int64_t>::max(), place);
            if (field.maximum < field.minimum) place.fail("the range of a field");
            const std::uint64_t range = static_cast<std::uint64_t>(field.maximum) -
                                        static_cast<std::uint64_t>(field.minimum);
            field.bits = static_cast<std::uint32_t>(std::bit_width(range));
            if (field.type == E57Field::Type::kScaledInteger) {
                field.scale = number_attribute(element, "scale", 1.0, place);
                field.offset = number_attribute(element, "offset", 0.0, place);
            }
        } else if (type == "String") {
            field.type = E57Field::Type::kString;
        } else {
            place.fail("a field");
        }
        fields.push_back(std::move(field));
    }
}

std::optional<E57Range> range_in(const E57Element* limits, const std::string& name) {
    if (limits == nullptr || limits->child(name + "Maximum") == nullptr) return std::nullopt;
    const E57Range range{number_in(*limits, name + "Minimum", 0.0),
                         number_in(*limits, name + "Maximum", 0.0)};
    if (!std::isfinite(range.least) || !std::isfinite(range.most) || range.most <= range.least) {
        return std::nullopt;
    }
    return range;
}

void read_pose(const E57Element& element, E57Scan& scan) {
    const E57Element* pose = element.child("pose");
    if (pose == nullptr) return;
    Eigen::Isometry3d T_world_scan = Eigen::Isometry3d::Identity();
    if (const E57Element* rotation = pose->child("rotation")) {
        const Eigen::Quaterniond q(number_in(*rotation, "w", 0.0), number_in(*rotation, "x", 0.0),
                                   number_in(*rotation, "y", 0.0), number_in(*rotation, "z", 0.0));
        if (!std::isfinite(q.norm()) || q.norm() < 1e-6) {
            scan.notes.push_back(fmt::format(
                "The pose of scan '{}' has no rotation (a zero quaternion); it is not used.",
                scan.name));
            return;
        }
        T_world_scan.linear() = q.normalized().toRotationMatrix();
    }
    if (const E57Element* translation = pose->child("translation")) {
        T_world_scan.translation() =
            Eigen::Vector3d(number_in(*translation, "x", 0.0), number_in(*translation, "y", 0.0),
                            number_in(*translation, "z", 0.0));
    }
    if (!T_world_scan.translation().allFinite()) {
        scan.notes.push_back(
            fmt::format("The pose of scan '{}' is not finite; it is not used.", scan.name));
        return;
    }
    scan.T_world_scan = T_world_scan;
}

E57Scan read_scan(const E57Element& element, const Place& place) {
    E57Scan scan;
    scan.name = text_in(element, "name");
    scan.description = text_in(element, "description");
    for (const char* part : {"sensorVendor", "sensorModel", "sensorSerialNumber"}) {
        const std::string text = text_in(element, part);
        if (!text.empty()) scan.sensor += (scan.sensor.empty() ? "" : " ") + text;
    }
    read_pose(element, scan);
    scan.intensity_limits = range_in(element.child("intensityLimits"), "intensity");
    const char* channels[] = {"colorRed", "colorGreen", "colorBlue"};
    for (int i = 0; i < 3; ++i) {
        scan.colour_limits[i] = range_in(element.child("colorLimits"), channels[i]);
    }

    const E57Element* points = element.child("points");
    if (points == nullptr) return scan;
    const E57Element* prototype = points->child("prototype");
    const std::optional<std::uint64_t> count = e57_count(points->attribute("recordCount"));
    const std::optional<std::uint64_t> offset = e57_count(points->attribute("fileOffset"));
    if (prototype == nullptr || !count || !offset) place.fail("the description of the points");
    read_fields(*prototype, place, scan.fields);
    scan.record_count = *count;
    scan.section = e57_logical(*offset);
    return scan;
}

}  // namespace

int E57Scan::field(std::string_view field_name) const {
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (fields[i].name == field_name) return static_cast<int>(i);
    }
    for (std::size_t i = 0; i < fields.size(); ++i) {
        const std::string_view full = fields[i].name;
        const std::size_t colon = full.find(':');
        if (full.substr(colon == std::string_view::npos ? 0 : colon + 1) == field_name)
            return static_cast<int>(i);
    }
    return -1;
}

E57File read_e57_header(E57Pages& pages) {
    const InputFile& file = pages.file();
    std::byte head[48];
    pages.read(0, head, sizeof(head));
    const auto major = load<std::uint32_t>(head + 8), minor = load<std::uint32_t>(head + 12);
    const auto file_bytes = load<std::uint64_t>(head + 16);
    const auto xml_at = load<std::uint64_t>(head + 24), xml_bytes = load<std::uint64_t>(head + 32);
    const auto page_bytes = load<std::uint64_t>(head + 40);
    if (major != 1 || page_bytes != kE57PageBytes) {
        file.fail(
            fmt::format("it is E57 {}.{} with pages of {} bytes, 1.x with {} is read; export it "
                        "again",
                        major, minor, page_bytes, kE57PageBytes));
    }
    if (file_bytes > file.size()) {
        file.fail(fmt::format("it has {} bytes of the {} that its header announces; copy it again",
                              file.size(), file_bytes));
    }
    const std::uint64_t xml_begin = e57_logical(xml_at);
    if (xml_begin > pages.size() || xml_bytes > pages.size() - xml_begin) {
        file.fail("its header puts the XML section where the file has none; copy it again");
    }
    if (xml_bytes > kMaxXmlBytes) {
        file.fail(
            fmt::format("its XML section has {} bytes, at most {} are read; export fewer scans "
                        "per file",
                        xml_bytes, kMaxXmlBytes));
    }
    std::string xml(xml_bytes, '\0');
    pages.read(xml_begin, xml.data(), xml.size());
    const E57Element root = parse_e57_xml(file, xml);

    E57File content;
    content.version = fmt::format("{}.{}", major, minor);
    content.library = text_in(root, "e57LibraryVersion");
    content.crs = text_in(root, "coordinateMetadata");
    if (const E57Element* scans = root.child("data3D")) {
        for (std::size_t i = 0; i < scans->children.size(); ++i) {
            content.scans.push_back(read_scan(scans->children[i], {file, i}));
        }
    }
    return content;
}

}  // namespace glowworm
