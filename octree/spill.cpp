#include "octree/spill.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <string>

#include "octree/error.h"
#include "octree/stale_files.h"

namespace glowworm {
namespace {

struct CloseFile {
    void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void fail(const std::filesystem::path& path, const char* what, int error) {
    const bool full = error == ENOSPC || error == EDQUOT;
    throw Error(full ? ExitCode::kBudget : ExitCode::kUnreadable,
                std::string(what) + " the temporary file '" + path.string() +
                    "': " + std::strerror(error) + "; choose another folder with --temp-dir");
}

}  // namespace

TemporaryFolder::TemporaryFolder(const std::filesystem::path& parent) {
    const std::string prefix = ".glowworm-build-";
    remove_stale(parent, prefix);
    std::string pattern = (parent / (prefix + "XXXXXX")).string();
    if (::mkdtemp(pattern.data()) == nullptr) fail(pattern, "cannot make", errno);
    path_ = pattern;
    descriptor_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor_ >= 0) hold(descriptor_);
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
    if (descriptor_ >= 0) ::close(descriptor_);
}

Spill::Spill(std::filesystem::path file, std::size_t buffered)
    : file_(std::move(file)), buffered_(buffered) {}

void Spill::add(const Surfel& surfel) {
    buffer_.push_back(surfel);
    ++size_;
    if (buffer_.size() >= buffered_) flush();
}

void Spill::flush() {
    if (buffer_.empty()) return;
    const File file(std::fopen(file_.c_str(), "ab"));
    if (file == nullptr) fail(file_, "cannot write", errno);
    std::setbuf(file.get(), nullptr);
    if (std::fwrite(buffer_.data(), sizeof(Surfel), buffer_.size(), file.get()) != buffer_.size()) {
        fail(file_, "cannot write", errno);
    }
    buffer_.clear();
}

std::vector<Surfel> Spill::take() {
    std::vector<Surfel> surfels;
    if (size_ > buffer_.size()) {
        flush();
        std::vector<Surfel>().swap(buffer_);
        surfels.resize(size_);
        const File file(std::fopen(file_.c_str(), "rb"));
        if (file == nullptr) fail(file_, "cannot read", errno);
        if (std::fread(surfels.data(), sizeof(Surfel), size_, file.get()) != size_) {
            fail(file_, "cannot read", std::ferror(file.get()) != 0 ? errno : EIO);
        }
        std::filesystem::remove(file_);
    } else {
        surfels.swap(buffer_);
    }
    size_ = 0;
    return surfels;
}

}  // namespace glowworm
