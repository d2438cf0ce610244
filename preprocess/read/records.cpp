#include "preprocess/read/records.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace glowworm {
namespace {

template <typename T>
struct TypeTag {
    using Type = T;
};

/// Calls `visit` with the C++ type of `type`.
template <typename Visit>
auto with_type(ScalarType type, Visit visit) {
    switch (type) {
        case ScalarType::kI8:
            return visit(TypeTag<std::int8_t>{});
        case ScalarType::kU8:
            return visit(TypeTag<std::uint8_t>{});
        case ScalarType::kI16:
            return visit(TypeTag<std::int16_t>{});
        case ScalarType::kU16:
            return visit(TypeTag<std::uint16_t>{});
        case ScalarType::kI32:
            return visit(TypeTag<std::int32_t>{});
        case ScalarType::kU32:
            return visit(TypeTag<std::uint32_t>{});
        case ScalarType::kI64:
            return visit(TypeTag<std::int64_t>{});
        case ScalarType::kU64:
            return visit(TypeTag<std::uint64_t>{});
        case ScalarType::kF32:
            return visit(TypeTag<float>{});
        case ScalarType::kF64:
            break;
    }
    return visit(TypeTag<double>{});
}

template <typename T, bool kSwapped>
T load(const std::byte* from) {
    std::byte bytes[sizeof(T)];
    std::memcpy(bytes, from, sizeof(T));
    if constexpr (kSwapped) std::reverse(bytes, bytes + sizeof(T));
    return std::bit_cast<T>(bytes);
}

template <typename To, typename From>
To convert(From value) {
    if constexpr (std::is_same_v<To, std::uint32_t> && !std::is_same_v<From, std::uint32_t>) {
        constexpr double kLargest = std::numeric_limits<std::uint32_t>::max();
        const double clamped = static_cast<double>(value);
        if (!(clamped > 0.0)) return 0;
        return static_cast<std::uint32_t>(std::min(clamped, kLargest));
    } else if constexpr (std::is_same_v<To, float> && std::is_same_v<From, double>) {
        // Beyond float's range the conversion is undefined; infinity is what it would mean.
        if (std::abs(value) > double{std::numeric_limits<float>::max()}) {
            return std::copysign(std::numeric_limits<float>::infinity(),
                                 static_cast<float>(value > 0 ? 1 : -1));
        }
        return static_cast<float>(value);
    } else {
        return static_cast<To>(value);
    }
}

/// Calls `store(i, value)` with each value of the field.
template <typename Store>
void for_each_value(const RecordLayout& layout, const RecordField& field, const std::byte* records,
                    std::size_t count, Store store) {
    with_type(field.stored, [&](auto tag) {
        using T = typename decltype(tag)::Type;
        const std::byte* from = records + field.offset;
        const std::size_t stride = field.stride;
        if (layout.swapped && sizeof(T) > 1) {
            for (std::size_t i = 0; i < count; ++i)
                store(i, load<T, true>(from + i * stride));
        } else {
            for (std::size_t i = 0; i < count; ++i)
                store(i, load<T, false>(from + i * stride));
        }
    });
}

/// `kStep` elements of `To` lie between the values of two points.
template <std::size_t kStep, typename To>
void decode_numbers(const RecordLayout& layout, const RecordField& field, const std::byte* records,
                    std::size_t count, To* to) {
    for_each_value(layout, field, records, count,
                   [to](std::size_t i, auto value) { to[i * kStep] = convert<To>(value); });
}

void decode_channel(const RecordLayout& layout, const RecordField& field, const std::byte* records,
                    std::size_t count, std::uint8_t* to) {
    if (field.stored == ScalarType::kU8 || field.stored == ScalarType::kI8) {
        const std::byte* from = records + field.offset;
        for (std::size_t i = 0; i < count; ++i) {
            to[i * 3] = static_cast<std::uint8_t>(from[i * field.stride]);
        }
        return;
    }
    const float factor = layout.colour_factor, rounding = layout.colour_rounding;
    for_each_value(layout, field, records, count, [=](std::size_t i, auto value) {
        const float scaled = convert<float>(value) * factor + rounding;
        to[i * 3] =
            scaled > 0.0f ? static_cast<std::uint8_t>(std::min(scaled, 255.0f)) : std::uint8_t{0};
    });
}

Rgb8 unpacked(std::uint32_t rgb) {
    return {static_cast<std::uint8_t>(rgb >> 16), static_cast<std::uint8_t>(rgb >> 8),
            static_cast<std::uint8_t>(rgb)};
}

void decode_packed(const RecordLayout& layout, const RecordField& field, const std::byte* records,
                   std::size_t count, Rgb8* to) {
    for_each_value(layout, field, records, count, [=](std::size_t i, auto value) {
        if constexpr (std::is_same_v<decltype(value), float>) {
            to[i] = unpacked(std::bit_cast<std::uint32_t>(value));
        } else {
            to[i] = unpacked(convert<std::uint32_t>(value));
        }
    });
}

const RecordField* field_of(const RecordLayout& layout, Column column) {
    const auto found = std::ranges::find(layout.fields, column, &RecordField::column);
    return found == layout.fields.end() ? nullptr : &*found;
}

bool has_three(const RecordLayout& layout, Column first) {
    const auto at = static_cast<std::uint8_t>(first);
    return field_of(layout, first) && field_of(layout, static_cast<Column>(at + 1)) &&
           field_of(layout, static_cast<Column>(at + 2));
}

bool is_float(ScalarType type) {
    return type == ScalarType::kF32 || type == ScalarType::kF64;
}

}  // namespace

std::size_t scalar_bytes(ScalarType type) {
    return with_type(type, [](auto tag) { return sizeof(typename decltype(tag)::Type); });
}

std::string_view scalar_name(ScalarType type) {
    constexpr std::string_view kNames[] = {"int8",   "uint8", "int16",  "uint16",  "int32",
                                           "uint32", "int64", "uint64", "float32", "float64"};
    return kNames[static_cast<std::size_t>(type)];
}

ColumnSet columns_of(const RecordLayout& layout) {
    return {.normals = has_three(layout, Column::kNormalX),
            .colours = has_three(layout, Column::kRed) || field_of(layout, Column::kPackedRgb),
            .intensities = field_of(layout, Column::kIntensity) != nullptr,
            .ndf_lengths = field_of(layout, Column::kNdf) != nullptr,
            .radii = field_of(layout, Column::kRadius) != nullptr,
            .stations = field_of(layout, Column::kStation) != nullptr,
            .emissions = has_three(layout, Column::kEmissionR),
            .times = field_of(layout, Column::kTime) != nullptr};
}

bool has_positions(const RecordLayout& layout) {
    return has_three(layout, Column::kX);
}

int colour_bits(const RecordLayout& layout) {
    if (!columns_of(layout).colours) return 0;
    if (!has_three(layout, Column::kRed)) return 8;
    const ScalarType type = field_of(layout, Column::kRed)->declared;
    if (is_float(type)) return 32;
    return scalar_bytes(type) == 1 || layout.colour_factor == 1.0f ? 8 : 16;
}

void choose_colour_factor(RecordLayout& layout, const std::byte* records, std::size_t count) {
    if (!has_three(layout, Column::kRed)) return;
    const ScalarType type = field_of(layout, Column::kRed)->declared;
    if (scalar_bytes(type) == 1) return;
    double largest = 0.0;
    for (const Column column : {Column::kRed, Column::kGreen, Column::kBlue}) {
        for_each_value(layout, *field_of(layout, column), records, count, [&](std::size_t, auto v) {
            largest = std::max(largest, static_cast<double>(v));
        });
    }
    const bool unit = is_float(type) && largest <= 1.0;
    layout.colour_factor = unit ? 255.0f : largest <= 255.0 ? 1.0f : 1.0f / 256.0f;
    layout.colour_rounding = unit ? 0.5f : 0.0f;
}

void decode_records(const RecordLayout& layout, const std::byte* records, std::size_t count,
                    std::size_t first, PointBlock& block) {
    const ColumnSet has = columns_of(layout);
    const bool separate_rgb = has_three(layout, Column::kRed);
    for (const RecordField& field : layout.fields) {
        const auto axis_from = [&](Column x) {
            return static_cast<std::size_t>(field.column) - static_cast<std::size_t>(x);
        };
        switch (field.column) {
            case Column::kNone:
                break;
            case Column::kX:
            case Column::kY:
            case Column::kZ:
                decode_numbers<3>(layout, field, records, count,
                                  &block.positions[first].x + axis_from(Column::kX));
                break;
            case Column::kNormalX:
            case Column::kNormalY:
            case Column::kNormalZ:
                if (has.normals) {
                    decode_numbers<3>(layout, field, records, count,
                                      &block.normals[first].x + axis_from(Column::kNormalX));
                }
                break;
            case Column::kRed:
            case Column::kGreen:
            case Column::kBlue:
                if (separate_rgb) {
                    decode_channel(layout, field, records, count,
                                   &block.colours[first].r + axis_from(Column::kRed));
                }
                break;
            case Column::kPackedRgb:
                if (!separate_rgb) {
                    decode_packed(layout, field, records, count, &block.colours[first]);
                }
                break;
            case Column::kIntensity:
                decode_numbers<1>(layout, field, records, count, &block.intensities[first]);
                break;
            case Column::kNdf:
                decode_numbers<1>(layout, field, records, count, &block.ndf_lengths[first]);
                break;
            case Column::kRadius:
                decode_numbers<1>(layout, field, records, count, &block.radii[first]);
                break;
            case Column::kStation:
                decode_numbers<1>(layout, field, records, count, &block.stations[first]);
                break;
            case Column::kEmissionR:
            case Column::kEmissionG:
            case Column::kEmissionB:
                if (has.emissions) {
                    decode_numbers<3>(layout, field, records, count,
                                      &block.emissions[first].x + axis_from(Column::kEmissionR));
                }
                break;
            case Column::kTime:
                decode_numbers<1>(layout, field, records, count, &block.times[first]);
                break;
        }
    }
}

}  // namespace glowworm
