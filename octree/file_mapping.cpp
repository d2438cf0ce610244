#include "octree/file_mapping.h"

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <mutex>
#include <system_error>
#include <thread>

namespace glowworm {
namespace {

/// A mapping as the handler sees it: lock-free, since a signal may come at any moment.
struct Slot {
    std::atomic<std::uintptr_t> begin{0}, end{0};
    std::atomic<bool> taken{false}, cut{false};
};

constexpr std::size_t kSlots = 4096;
std::array<Slot, kSlots> slots;
/// Held while slots change: what is unmapped may be anyone's memory next, so nothing is forgotten
/// then. Not a mutex, since a signal's handler asks for it.
std::atomic_flag changing = ATOMIC_FLAG_INIT;
struct Changing {
    Changing() {
        while (changing.test_and_set())
            std::this_thread::yield();
    }
    ~Changing() { changing.clear(); }
};

struct sigaction previous_action;
std::uintptr_t page_bytes;

/// Puts a page of zeros where the file has none any more (as systemd's sigbus.c does).
void replace_missing_page(int, siginfo_t* info, void*) {
    const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    for (Slot& slot : slots) {
        if (address < slot.begin.load() || address >= slot.end.load()) continue;
        slot.cut.store(true);
        void* page = reinterpret_cast<void*>(address & ~(page_bytes - 1));
        if (::mmap(page, page_bytes, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) !=
            MAP_FAILED) {
            return;
        }
    }
    ::sigaction(SIGBUS, &previous_action, nullptr);  // the fault repeats, under the old action
}

void install_handler() {
    static std::once_flag once;
    std::call_once(once, [] {
        page_bytes = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
        struct sigaction action {};
        action.sa_sigaction = replace_missing_page;
        action.sa_flags = SA_SIGINFO;
        ::sigaction(SIGBUS, &action, &previous_action);
    });
}

std::size_t take_slot(void* data, std::uint64_t bytes) {
    for (std::size_t i = 0; i < kSlots; ++i) {
        if (slots[i].taken.exchange(true)) continue;
        slots[i].cut.store(false);
        slots[i].begin.store(reinterpret_cast<std::uintptr_t>(data));
        slots[i].end.store(reinterpret_cast<std::uintptr_t>(data) + bytes);
        return i;
    }
    throw std::system_error(EMFILE, std::generic_category(), "too many mapped files");
}

}  // namespace

FileMapping::FileMapping(int descriptor, std::uint64_t bytes)
    : data_(::mmap(nullptr, bytes, PROT_READ, MAP_SHARED, descriptor, 0)), bytes_(bytes) {
    if (data_ == MAP_FAILED) throw std::system_error(errno, std::generic_category());
    install_handler();
    const Changing alone;
    try {
        slot_ = take_slot(data_, bytes);
    } catch (...) {
        ::munmap(data_, bytes_);
        throw;
    }
}

FileMapping::~FileMapping() {
    const Changing alone;
    slots[slot_].end.store(0);
    slots[slot_].begin.store(0);
    ::munmap(data_, bytes_);
    slots[slot_].taken.store(false);
}

bool FileMapping::is_intact() const {
    return !slots[slot_].cut.load();
}

void FileMapping::forget_pages() const {
    // A page of zeros in place of a missing one would be forgotten as well, but it comes again.
    ::madvise(data_, bytes_, MADV_DONTNEED);
}

void forget_mapped_pages() {
    if (changing.test_and_set()) return;
    for (const Slot& slot : slots) {
        const std::uintptr_t begin = slot.begin, end = slot.end;
        if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_DONTNEED);
    }
    changing.clear();
}

}  // namespace glowworm
