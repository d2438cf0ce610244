#include "preprocess/read/input_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "octree/error.h"

namespace glowworm {

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)) {
    // Non-blocking, or opening a pipe would wait for a writer.
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0)
        fail(std::string(std::strerror(errno)) + "; check the path and its permissions");
    struct ::stat status {};
    std::string reason;
    if (::fstat(descriptor_, &status) != 0) {
        reason = std::string(std::strerror(errno)) + "; check the path and its permissions";
    } else if (S_ISDIR(status.st_mode)) {
        reason = "it is a folder; name the scan files in it";
    } else if (!S_ISREG(status.st_mode)) {
        reason = "it is a pipe or a device; save the scan as a file first";
    } else if (status.st_size == 0) {
        reason = "it is empty (0 bytes); copy or export it again";
    }
    if (!reason.empty()) {
        ::close(std::exchange(descriptor_, -1));
        fail(reason);
    }
    size_ = static_cast<std::uint64_t>(status.st_size);
    ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
}

InputFile::~InputFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
}

InputFile::InputFile(InputFile&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      size_(other.size_) {}

std::size_t InputFile::read_some(std::uint64_t offset, void* into, std::size_t bytes) const {
    if (offset >= size_) return 0;
    char* next = static_cast<char*>(into);
    std::size_t got = 0;
    while (got < bytes) {
        const ssize_t more =
            ::pread(descriptor_, next + got, bytes - got, static_cast<off_t>(offset + got));
        if (more < 0 && errno == EINTR) continue;
        if (more < 0) fail(std::string(std::strerror(errno)) + "; check the disk it is on");
        if (more == 0) break;
        got += static_cast<std::size_t>(more);
    }
    return got;
}

void InputFile::read_exactly(std::uint64_t offset, void* into, std::size_t bytes) const {
    if (read_some(offset, into, bytes) != bytes) {
        fail("it ends before its header says it does; copy or export it again");
    }
}

void InputFile::fail(const std::string& reason) const {
    throw Error(ExitCode::kUnreadable, "cannot read '" + path_.string() + "': " + reason);
}

}  // namespace glowworm
