#include "preprocess/write/records.h"

#include <bit>
#include <cstring>
#include <initializer_list>
#include <type_traits>

namespace glowworm {
namespace {

static_assert(std::endian::native == std::endian::little,
              "records are written as they lie in memory");

/// Calls `visit(column, names, type)` with each column that is there, in the order of the record.
template <typename Visit>
void for_each_column(const Points& points, Visit visit) {
    using Names = std::initializer_list<std::string_view>;
    const auto visit_if_there = [&](const auto& column, Names names, std::string_view type) {
        if (!column.empty()) visit(column, names, type);
    };
    visit(points.positions, Names{"x", "y", "z"}, "float");
    visit_if_there(points.normals, {"nx", "ny", "nz"}, "float");
    visit_if_there(points.colours, {"red", "green", "blue"}, "uchar");
    visit_if_there(points.intensities, {"intensity"}, "float");
    visit_if_there(points.ndf_lengths, {"ndf"}, "float");
    visit_if_there(points.radii, {"radius"}, "float");
    visit_if_there(points.stations, {"station"}, "uint");
    visit_if_there(points.emissions, {"emission_r", "emission_g", "emission_b"}, "float");
    visit_if_there(points.times, {"time"}, "double");
}

template <typename Column>
constexpr std::size_t kElementBytes = sizeof(typename std::remove_cvref_t<Column>::value_type);

template <typename Column>
constexpr bool kIsColour = std::is_same_v<typename std::remove_cvref_t<Column>::value_type, Rgb8>;

std::uint32_t packed(const Rgb8& colour) {
    return std::uint32_t{colour.r} << 16 | std::uint32_t{colour.g} << 8 | colour.b;
}

}  // namespace

std::vector<WrittenField> written_fields(const Points& points, ColourForm form,
                                         std::span<const ExtraColumn> extra) {
    std::vector<WrittenField> fields;
    for_each_column(points, [&](const auto& column, auto names, std::string_view type) {
        if (kIsColour<decltype(column)> && form == ColourForm::kPacked) {
            fields.push_back({"rgb", "uint", sizeof(std::uint32_t)});
            return;
        }
        for (const std::string_view name : names) {
            fields.push_back({name, type, kElementBytes<decltype(column)> / names.size()});
        }
    });
    for (const ExtraColumn& column : extra)
        fields.push_back({column.name, "float", sizeof(float)});
    return fields;
}

std::vector<std::byte> write_records(const Points& points, ColourForm form, std::size_t begin,
                                     std::size_t end, std::span<const ExtraColumn> extra) {
    std::size_t stride = 0;
    for (const WrittenField& field : written_fields(points, form, extra))
        stride += field.bytes;
    std::vector<std::byte> records((end - begin) * stride);
    std::size_t offset = 0;
    const auto write = [&](const auto& column, auto value_of) {
        using Value = decltype(value_of(column[0]));
        std::byte* to = records.data() + offset;
        for (std::size_t i = begin; i < end; ++i, to += stride) {
            const Value value = value_of(column[i]);
            std::memcpy(to, &value, sizeof value);
        }
        offset += sizeof(Value);
    };
    const auto as_it_is = [](const auto& value) { return value; };
    for_each_column(points, [&](const auto& column, auto, std::string_view) {
        if constexpr (kIsColour<decltype(column)>) {
            if (form == ColourForm::kPacked) return write(column, packed);
        }
        write(column, as_it_is);
    });
    for (const ExtraColumn& column : extra)
        write(column.values, as_it_is);
    return records;
}

}  // namespace glowworm
