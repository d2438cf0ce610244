#include "preprocess/read/las_records.h"

#include <vector>

#include "preprocess/read/laz_chunks.h"
#include "preprocess/read/laz_pointwise.h"

namespace glowworm {
namespace {

class PlainRecords final : public LasRecordStream {
  public:
    PlainRecords(const InputFile& file, const LasHeader& header) : file_(file), header_(header) {}

    void read(std::byte* records, std::size_t count) override {
        const std::size_t bytes = count * header_.record_bytes;
        file_.read_exactly(header_.point_offset + done_, records, bytes);
        done_ += bytes;
    }

  private:
    const InputFile& file_;
    const LasHeader& header_;
    std::uint64_t done_ = 0;  // bytes
};

class CompressedRecords final : public LasRecordStream {
  public:
    CompressedRecords(const InputFile& file, const LasHeader& header, const LazLayers& wanted)
        : file_(file) {
        const std::vector<std::byte> record =
            read_las_record(file, header, "laszip encoded", 22204);
        if (record.empty()) {
            file.fail("it is compressed but its LASzip record is missing; copy or export it again");
        }
        layout_ = read_laz_layout(file, record, header.record_bytes);
        if (layout_.layered != (header.point_format > 5)) {
            file.fail("its LASzip record contradicts its header; copy the file again");
        }
        chunks_ = read_laz_chunks(file, layout_, header.point_offset, header.point_count);
        decoder_ = layout_.layered ? make_layered_decoder(file, layout_, wanted)
                                   : make_pointwise_decoder(file, layout_);
    }

    void read(std::byte* records, std::size_t count) override {
        for (std::size_t i = 0; i < count; ++i) {
            if (left_ == 0) {
                if (next_ == chunks_.size()) file_.fail("it ends before its points do");
                left_ = chunks_[next_].points;
                decoder_->start(chunks_[next_++]);
            }
            decoder_->next(records + i * layout_.record_bytes);
            --left_;
        }
    }

    std::string compression() const override { return layout_.version; }

  private:
    const InputFile& file_;
    LazLayout layout_;
    std::vector<LazChunk> chunks_;
    std::size_t next_ = 0;
    std::uint64_t left_ = 0;  // points of the chunk before next_
    std::unique_ptr<LazChunkDecoder> decoder_;
};

}  // namespace

std::unique_ptr<LasRecordStream> open_las_records(const InputFile& file, const LasHeader& header,
                                                  const LazLayers& wanted) {
    if (header.compressed) return std::make_unique<CompressedRecords>(file, header, wanted);
    return std::make_unique<PlainRecords>(file, header);
}

}  // namespace glowworm
