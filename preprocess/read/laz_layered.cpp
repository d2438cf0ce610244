#include "preprocess/read/laz_layered.h"

#include <array>
#include <cstring>
#include <vector>

#include "preprocess/read/laz_colour.h"
#include "preprocess/read/laz_point14.h"
#include "preprocess/read/little_endian.h"

namespace glowworm {
namespace {

/// State of an item for each scanner channel. A channel that comes up for the first time in a chunk
/// goes on from the last values of the channel before it.
template <typename State, typename Last>
class Channels {
  public:
    /// `keeps_stale_last`: version 3 of the format goes on predicting from (and updating) the
    /// values of the channel before the switch until the next point, where the new channel was in
    /// use already; version 4 does not. Both ends do it, so it decodes.
    explicit Channels(bool keeps_stale_last) : keeps_stale_last_(keeps_stale_last) {}

    void start(std::uint32_t channel, const Last& first) {
        in_use_.fill(false);
        begin(channel, first);
        current_ = channel;
    }

    struct Here {
        State& state;
        Last& last;
    };

    Here at(std::uint32_t channel) {
        std::uint32_t last = current_;
        if (channel != current_) {
            const bool fresh = !in_use_[channel];
            if (fresh) begin(channel, lasts_[current_]);
            if (fresh || !keeps_stale_last_) last = channel;
            current_ = channel;
        }
        return {*states_[channel], lasts_[last]};
    }

  private:
    void begin(std::uint32_t channel, const Last& last) {
        if (!states_[channel]) states_[channel] = std::make_unique<State>();
        states_[channel]->reset();
        lasts_[channel] = last;
        in_use_[channel] = true;
    }

    bool keeps_stale_last_;
    std::uint32_t current_ = 0;
    std::array<bool, 4> in_use_{};
    std::array<std::unique_ptr<State>, 4> states_;
    std::array<Last, 4> lasts_{};
};

struct InfraredState {
    SymbolModel changed, low, high;
    void reset() {
        for (SymbolModel* model : {&changed, &low, &high})
            model->retire();
    }
    std::uint16_t next(ArithmeticDecoder& decoder, std::uint16_t last) {
        const std::uint32_t which = next_symbol(decoder, changed, 4);
        std::uint32_t bytes[2] = {last & 255u, static_cast<std::uint32_t>(last >> 8)};
        if (which & 1) bytes[0] = (bytes[0] + next_symbol(decoder, low, 256)) & 255;
        if (which & 2) bytes[1] = (bytes[1] + next_symbol(decoder, high, 256)) & 255;
        return static_cast<std::uint16_t>(bytes[0] | bytes[1] << 8);
    }
};

struct ByteState {
    SymbolModel model;
    void reset() { model.retire(); }
};

/// An item of the records and its layers: one for colours, one for infrared, one per extra byte.
struct ColourItem {
    const LazItem* item;
    LazLayer layer;
    Channels<ColourDecoder, Rgb16> channels;
};
struct InfraredItem {
    const LazItem* item;
    LazLayer layer;
    Channels<InfraredState, std::uint16_t> channels;
};
struct ByteItem {
    std::uint32_t offset;
    LazLayer layer;
    Channels<ByteState, std::uint8_t> channels;
};

class LayeredDecoder final : public LazChunkDecoder {
  public:
    LayeredDecoder(const InputFile& file, const LazLayout& layout, const LazLayers& wanted)
        : file_(file), layout_(layout), wanted_(wanted), first_record_(layout.record_bytes) {
        for (const LazItem& item : layout.items) {
            const bool stale = item.version < 4;
            switch (item.type) {
                case LazItemType::kPoint14:
                    point_layers_at_ = sizes_.size();
                    grow(9);
                    break;
                case LazItemType::kRgb14:
                    add_colour(item, stale);
                    break;
                case LazItemType::kRgbNir14:
                    add_colour(item, stale);
                    infrared_at_ = sizes_.size();
                    grow(1);
                    if (wanted.infrared) {
                        infrared_ = std::make_unique<InfraredItem>(
                            InfraredItem{&item, {}, Channels<InfraredState, std::uint16_t>(stale)});
                    }
                    break;
                case LazItemType::kByte14:
                    bytes_at_ = sizes_.size();
                    grow(item.bytes);
                    for (std::uint32_t i = 0; wanted.extra_bytes && i < item.bytes; ++i) {
                        bytes_.push_back(
                            {item.offset + i, {}, Channels<ByteState, std::uint8_t>(stale)});
                    }
                    break;
                default:
                    grow(1);  // a wave packet
            }
        }
    }

    void start(const LazChunk& chunk) override {
        chunk_ = chunk;
        first_ = true;
    }

    void next(std::byte* record) override {
        if (first_) {
            first_ = false;
            read_first();
            std::memcpy(record, first_record_.data(), first_record_.size());
            return;
        }
        std::memcpy(record, first_record_.data(), first_record_.size());
        point_.next(point_layers_, record);
        const std::uint32_t channel = point_.channel();
        if (colour_ && colour_->layer.present) {
            auto [state, last] = colour_->channels.at(channel);
            last = state.next(colour_->layer.decoder, last);
            store(record + colour_->item->offset, last);
        }
        if (infrared_ && infrared_->layer.present) {
            auto [state, last] = infrared_->channels.at(channel);
            last = state.next(infrared_->layer.decoder, last);
            store(record + infrared_->item->offset + 6, last);
        }
        for (ByteItem& byte : bytes_) {
            if (!byte.layer.present) continue;
            auto [state, last] = byte.channels.at(channel);
            last =
                static_cast<std::uint8_t>(last + next_symbol(byte.layer.decoder, state.model, 256));
            record[byte.offset] = static_cast<std::byte>(last);
        }
    }

  private:
    void grow(std::size_t layers) { sizes_.resize(sizes_.size() + layers); }

    void add_colour(const LazItem& item, bool stale) {
        colour_at_ = sizes_.size();
        grow(1);
        if (wanted_.colour) {
            colour_ = std::make_unique<ColourItem>(
                ColourItem{&item, {}, Channels<ColourDecoder, Rgb16>(stale)});
        }
    }

    /// A chunk is its first point as it is, its number of points, the sizes of its layers, and the
    /// layers.
    void read_first() {
        const std::uint64_t head = layout_.record_bytes + 4 + 4 * std::uint64_t{sizes_.size()};
        if (head > chunk_.end - chunk_.begin) fail();
        file_.read_exactly(chunk_.begin, first_record_.data(), first_record_.size());
        std::uint64_t at = chunk_.begin + layout_.record_bytes + 4;
        file_.read_exactly(at, sizes_.data(), 4 * sizes_.size());
        at += 4 * sizes_.size();
        starts_.clear();
        for (const std::uint32_t size : sizes_) {
            starts_.push_back(at);
            at += size;
        }
        if (at > chunk_.end) fail();

        point_.start(first_record_.data());
        for (std::size_t i = 0; i < point_layers_.size(); ++i) {
            open(point_layers_[i], point_layers_at_ + i, wants(static_cast<Point14Layer>(i)));
        }
        // The returns and x, y are always coded.
        if (!point_layers_[0].present) {
            point_layers_[0].decoder.open(file_, chunk_.begin, chunk_.begin);
        }
        const std::uint32_t channel = point_.channel();
        if (colour_) {
            open(colour_->layer, colour_at_, true);
            colour_->channels.start(channel,
                                    load<Rgb16>(first_record_.data() + colour_->item->offset));
        }
        if (infrared_) {
            open(infrared_->layer, infrared_at_, true);
            infrared_->channels.start(
                channel, load<std::uint16_t>(first_record_.data() + infrared_->item->offset + 6));
        }
        for (std::size_t i = 0; i < bytes_.size(); ++i) {
            open(bytes_[i].layer, bytes_at_ + i, true);
            bytes_[i].channels.start(
                channel, std::to_integer<std::uint8_t>(first_record_[bytes_[i].offset]));
        }
    }

    bool wants(Point14Layer layer) const {
        switch (layer) {
            case Point14Layer::kReturnsXy:
            case Point14Layer::kZ:
                return true;
            case Point14Layer::kFlags:
                return wanted_.flags;
            case Point14Layer::kIntensity:
                return wanted_.intensity;
            case Point14Layer::kGpsTime:
                return wanted_.gps_time;
            default:
                return wanted_.classification;
        }
    }

    void open(LazLayer& layer, std::size_t index, bool wanted) {
        layer.present = wanted && sizes_[index] > 0;
        if (layer.present) {
            layer.decoder.open(file_, starts_[index], starts_[index] + sizes_[index]);
        }
    }

    [[noreturn]] void fail() const {
        file_.fail("a chunk of its compressed points is damaged; copy the file again");
    }

    const InputFile& file_;
    const LazLayout& layout_;
    LazLayers wanted_;
    LazChunk chunk_;
    bool first_ = true;
    std::vector<std::byte> first_record_;
    std::vector<std::uint32_t> sizes_;   // of all layers, in the order of the file
    std::vector<std::uint64_t> starts_;  // in the file
    std::size_t point_layers_at_ = 0, colour_at_ = 0, infrared_at_ = 0, bytes_at_ = 0;

    Point14Decoder point_;
    Point14Layers point_layers_;
    std::unique_ptr<ColourItem> colour_;
    std::unique_ptr<InfraredItem> infrared_;
    std::vector<ByteItem> bytes_;
};

}  // namespace

std::unique_ptr<LazChunkDecoder> make_layered_decoder(const InputFile& file,
                                                      const LazLayout& layout,
                                                      const LazLayers& wanted) {
    return std::make_unique<LayeredDecoder>(file, layout, wanted);
}

}  // namespace glowworm
