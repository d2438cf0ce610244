#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "preprocess/read/e57_header.h"

namespace glowworm {

/// The records of a CompressedVector (ASTM E2807-11, 9.3), front to back. Packets are taken one
/// after the other, index packets are passed over, so nothing can point backwards.
class E57Vector {
  public:
    /// Reads the fields of `scan` whose indices are `wanted`. Throws Error (kUnreadable) where the
    /// section's header is damaged or the scan announces more points than its bytes can hold.
    E57Vector(E57Pages& pages, const E57Scan& scan, std::vector<std::size_t> wanted);

    std::uint64_t records_left() const { return left_; }

    /// Decodes up to `most` of the next records: `values[i]` gets field wanted[i] of each. Returns
    /// how many; 0 after the last.
    std::size_t read(std::size_t most, std::vector<std::vector<double>>& values);

  private:
    /// The bytes of a field that came in packets and were not decoded yet.
    struct Stream {
        const E57Field* field;
        std::size_t number;            // among all fields
        std::vector<std::byte> bytes;  // with 8 spare ones at the end
        std::size_t used = 0;          // without the spare ones
        std::uint64_t first_bit = 0;   // of the value that comes next

        std::uint64_t ready() const;
        void append(E57Pages& pages, std::uint64_t at, std::size_t count);
        void decode(std::size_t count, double* values);
        void drop_decoded();
    };

    bool read_packet();
    std::uint64_t ready() const;

    E57Pages& pages_;
    std::size_t field_count_;
    std::vector<Stream> streams_;
    std::uint64_t left_;
    std::uint64_t at_ = 0, end_ = 0;  // logical: next packet, end of the section
};

}  // namespace glowworm
