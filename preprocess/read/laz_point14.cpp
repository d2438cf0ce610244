#include "preprocess/read/laz_point14.h"

#include <algorithm>

#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

std::uint8_t byte_at(const std::byte* record, std::size_t offset) {
    return std::to_integer<std::uint8_t>(record[offset]);
}

/// Context of a point's differences, a digit by number of returns (row) and return number. Part of
/// the format.
constexpr const char* kReturnContext[16] = {
    "0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
    "4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
    "4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
    "5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455",
};

/// 1 for a first return, plus 2 for a last one.
std::uint32_t return_kind(const Point14& point) {
    return (point.return_number == 1 ? 1u : 0u) + (point.return_number >= point.returns ? 2u : 0u);
}

}  // namespace

void Point14::unpack(const std::byte* record) {
    x = load<std::int32_t>(record);
    y = load<std::int32_t>(record + 4);
    z = load<std::int32_t>(record + 8);
    intensity = load<std::uint16_t>(record + 12);
    return_number = byte_at(record, 14) & 15;
    returns = byte_at(record, 14) >> 4;
    flags = static_cast<std::uint8_t>((byte_at(record, 15) & 15) | (byte_at(record, 15) >> 6) << 4);
    channel = (byte_at(record, 15) >> 4) & 3;
    classification = byte_at(record, 16);
    user_data = byte_at(record, 17);
    scan_angle = load<std::int16_t>(record + 18);
    source = load<std::uint16_t>(record + 20);
    gps_time = load<std::uint64_t>(record + 22);
}

void Point14::pack(std::byte* record) const {
    store(record, x);
    store(record + 4, y);
    store(record + 8, z);
    store(record + 12, intensity);
    record[14] = static_cast<std::byte>(return_number | returns << 4);
    record[15] = static_cast<std::byte>((flags & 15) | channel << 4 | (flags >> 4) << 6);
    record[16] = static_cast<std::byte>(classification);
    record[17] = static_cast<std::byte>(user_data);
    store(record + 18, scan_angle);
    store(record + 20, source);
    store(record + 22, gps_time);
}

struct Point14Decoder::Context {
    Point14 last;
    bool time_changed = false;  // from the point before the last to the last

    std::array<SymbolModel, 8> changed;
    SymbolModel channel_step, return_step;
    std::array<SymbolModel, 16> returns, return_number;
    std::array<RunningMedian, 12> x_steps, y_steps;
    std::array<std::int32_t, 8> heights{};
    std::array<std::uint16_t, 8> intensities{};
    std::array<SymbolModel, 64> classification, flags, user_data;
    IntegerDecoder x{32, 2}, y{32, 22}, z{32, 20};
    IntegerDecoder intensity{16, 4}, scan_angle{16, 2}, source{16, 1};
    GpsTimeDecoder<false> time;

    void start(const Point14& point) {
        last = point;
        time_changed = false;
        for (auto* models : {&classification, &flags, &user_data}) {
            for (SymbolModel& model : *models)
                model.retire();
        }
        for (auto* models : {&returns, &return_number}) {
            for (SymbolModel& model : *models)
                model.retire();
        }
        for (SymbolModel& model : changed)
            model.retire();
        channel_step.retire();
        return_step.retire();
        for (IntegerDecoder* integer : {&x, &y, &z, &intensity, &scan_angle, &source}) {
            integer->reset();
        }
        x_steps.fill({});
        y_steps.fill({});
        heights.fill(point.z);
        intensities.fill(point.intensity);
        time.start(point.gps_time);
    }
};

Point14Decoder::Point14Decoder() = default;
Point14Decoder::~Point14Decoder() = default;

Point14Decoder::Context& Point14Decoder::begin_context(std::uint32_t channel,
                                                       const Point14& point) {
    if (!contexts_[channel]) contexts_[channel] = std::make_unique<Context>();
    contexts_[channel]->start(point);
    in_use_[channel] = true;
    return *contexts_[channel];
}

void Point14Decoder::start(const std::byte* record) {
    Point14 point;
    point.unpack(record);
    in_use_.fill(false);
    channel_ = point.channel;
    begin_context(channel_, point);
}

void Point14Decoder::read_returns(Context& context, ArithmeticDecoder& decoder,
                                  std::uint32_t changed) {
    Point14& point = context.last;
    const std::uint32_t before = point.return_number;
    if (changed & 4) {
        point.returns =
            static_cast<std::uint8_t>(next_symbol(decoder, context.returns[point.returns], 16));
    }
    std::uint32_t now = before;
    switch (changed & 3) {
        case 1:
            now = before + 1;
            break;
        case 2:
            now = before + 15;
            break;
        case 3:
            now = changed & 16 ? next_symbol(decoder, context.return_number[before], 16)
                               : before + 2 + next_symbol(decoder, context.return_step, 13);
            break;
        default:
            break;
    }
    point.return_number = static_cast<std::uint8_t>(now & 15);
}

void Point14Decoder::next(Point14Layers& layers, std::byte* record) {
    const auto layer = [&](Point14Layer which) -> LazLayer& {
        return layers[static_cast<std::size_t>(which)];
    };
    ArithmeticDecoder& main = layer(Point14Layer::kReturnsXy).decoder;

    // What changes: 1, 2 return number, 4 returns, 8 scan angle, 16 time, 32 source, 64 channel.
    Context* context = contexts_[channel_].get();
    const std::uint32_t kind_before =
        return_kind(context->last) + (context->time_changed ? 4u : 0u);
    const std::uint32_t changed = next_symbol(main, context->changed[kind_before], 128);
    if (changed & 64) {
        const std::uint32_t step = next_symbol(main, context->channel_step, 3);
        channel_ = (channel_ + step + 1) & 3;
        context =
            in_use_[channel_] ? contexts_[channel_].get() : &begin_context(channel_, context->last);
        context->last.channel = static_cast<std::uint8_t>(channel_);
    }
    const std::uint32_t time_changed = (changed >> 4) & 1;
    read_returns(*context, main, changed);

    Point14& point = context->last;
    const std::uint32_t n = point.returns, r = point.return_number;
    const std::uint32_t steps =
        static_cast<std::uint32_t>(kReturnContext[n][r] - '0') << 1 | time_changed;
    const std::uint32_t level = std::min(n > r ? n - r : r - n, 7u);
    const std::uint32_t kind = return_kind(point);
    const std::uint32_t single = n == 1 ? 1 : 0;

    const std::int32_t dx = context->x.next(main, context->x_steps[steps].median(), single);
    point.x = wrapping_add(point.x, dx);
    context->x_steps[steps].add(dx);
    std::uint32_t k = context->x.magnitude();
    const std::int32_t dy =
        context->y.next(main, context->y_steps[steps].median(), single + (k < 20 ? k & ~1u : 20));
    point.y = wrapping_add(point.y, dy);
    context->y_steps[steps].add(dy);

    if (LazLayer& z = layer(Point14Layer::kZ); z.present) {
        k = (context->x.magnitude() + context->y.magnitude()) / 2;
        point.z =
            context->z.next(z.decoder, context->heights[level], single + (k < 18 ? k & ~1u : 18));
        context->heights[level] = point.z;
    }
    if (LazLayer& classes = layer(Point14Layer::kClassification); classes.present) {
        SymbolModel& model =
            context->classification[(point.classification & 31u) << 1 | (kind == 3 ? 1u : 0u)];
        point.classification = static_cast<std::uint8_t>(next_symbol(classes.decoder, model, 256));
    }
    if (LazLayer& flags = layer(Point14Layer::kFlags); flags.present) {
        point.flags =
            static_cast<std::uint8_t>(next_symbol(flags.decoder, context->flags[point.flags], 64));
    }
    if (LazLayer& intensity = layer(Point14Layer::kIntensity); intensity.present) {
        std::uint16_t& last = context->intensities[kind << 1 | time_changed];
        last = static_cast<std::uint16_t>(context->intensity.next(intensity.decoder, last, kind));
        point.intensity = last;
    }
    if (LazLayer& angle = layer(Point14Layer::kScanAngle); angle.present && (changed & 8) != 0) {
        point.scan_angle = static_cast<std::int16_t>(
            context->scan_angle.next(angle.decoder, point.scan_angle, time_changed));
    }
    if (LazLayer& user = layer(Point14Layer::kUserData); user.present) {
        point.user_data = static_cast<std::uint8_t>(
            next_symbol(user.decoder, context->user_data[point.user_data / 4], 256));
    }
    if (LazLayer& source = layer(Point14Layer::kSource); source.present && (changed & 32) != 0) {
        point.source =
            static_cast<std::uint16_t>(context->source.next(source.decoder, point.source));
    }
    if (LazLayer& time = layer(Point14Layer::kGpsTime); time.present && time_changed != 0) {
        point.gps_time = context->time.next(time.decoder);
    }
    context->time_changed = time_changed != 0;
    point.pack(record);
}

}  // namespace glowworm
