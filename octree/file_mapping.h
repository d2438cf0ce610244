#pragma once

#include <cstddef>
#include <cstdint>

namespace glowworm {

/// A file mapped read-only that may shrink while it is mapped without killing the program. Reading
/// behind the new end would raise SIGBUS; here it reads zeros and `is_intact` turns false. To that
/// end the first mapping installs a handler for SIGBUS in this process; faults elsewhere go to the
/// handler that was there before.
class FileMapping {
  public:
    /// Maps `bytes` > 0 of an open file. Throws std::system_error.
    FileMapping(int descriptor, std::uint64_t bytes);
    ~FileMapping();
    FileMapping(const FileMapping&) = delete;
    FileMapping& operator=(const FileMapping&) = delete;

    const void* data() const { return data_; }

    /// False once a page that was read turned out to be gone. Pages not read yet are not known of.
    bool is_intact() const;

    /// Lets the system take back the pages read so far.
    void forget_pages() const;

  private:
    void* data_;
    std::uint64_t bytes_;
    std::size_t slot_;
};

/// Lets the system take back the pages of all files mapped now, unless one is being mapped or
/// unmapped. A signal's handler may call it.
void forget_mapped_pages();

}  // namespace glowworm
