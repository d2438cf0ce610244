#include "octree/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "octree/error.h"
#include "octree/stale_files.h"

namespace glowworm {
namespace {

constexpr std::size_t kLongestWrite = std::size_t{1}
                                      << 20;  // bytes between which a signal is heard

[[noreturn]] void throw_write_error(const std::filesystem::path& path, int error) {
    const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
    throw Error(full ? ExitCode::kBudget : ExitCode::kUnreadable,
                "cannot write '" + path.string() + "': " + std::strerror(error) +
                    (full ? "; free some space or choose another disk"
                          : "; check that the folder exists and may be written"));
}

std::filesystem::path folder_of(const std::filesystem::path& path) {
    return path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path final_path)
    : final_path_(std::move(final_path)), temporary_path_(final_path_) {
    temporary_path_.replace_filename(partial_name(final_path_.filename()));
    if (std::filesystem::is_directory(final_path_)) throw_write_error(final_path_, EISDIR);
    remove_stale_partials(folder_of(final_path_));
    descriptor_ = ::open(temporary_path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    if (descriptor_ < 0) throw_write_error(final_path_, errno);
    hold(descriptor_);
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : final_path_(std::move(other.final_path_)),
      temporary_path_(std::move(other.temporary_path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      position_(other.position_) {}

AtomicFile::~AtomicFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(temporary_path_.c_str());
}

void AtomicFile::write(const void* data, std::size_t bytes) {
    write_at(position_, data, bytes);
    position_ += bytes;
}

void AtomicFile::write_at(std::uint64_t offset, const void* data, std::size_t bytes) {
    const char* next = static_cast<const char*>(data);
    while (bytes > 0) {
        const ssize_t written =
            ::pwrite(descriptor_, next, std::min(bytes, kLongestWrite), static_cast<off_t>(offset));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) throw_write_error(final_path_, written < 0 ? errno : ENOSPC);
        next += written;
        offset += static_cast<std::uint64_t>(written);
        bytes -= static_cast<std::size_t>(written);
    }
}

void AtomicFile::commit(bool synced) {
    if (synced && ::fsync(descriptor_) != 0) throw_write_error(final_path_, errno);
    if (::close(std::exchange(descriptor_, -1)) != 0 ||
        ::rename(temporary_path_.c_str(), final_path_.c_str()) != 0) {
        const int error = errno;
        ::unlink(temporary_path_.c_str());
        throw_write_error(final_path_, error);
    }
    if (!synced) return;
    const int folder = ::open(folder_of(final_path_).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (folder >= 0) {
        ::fsync(folder);
        ::close(folder);
    }
}

}  // namespace glowworm
