#include "preprocess/command/paged_memory.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/mman.h>
#include <tbb/task_scheduler_observer.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <ctime>
#include <new>
#include <string>

#include "octree/error.h"
#include "octree/file_mapping.h"

namespace glowworm {
namespace {

constexpr std::size_t kLarge = std::size_t{1} << 17;  // bytes: smaller blocks stay in memory
constexpr std::size_t kMostAddresses = std::size_t{1} << 44;  // of which none is used twice
constexpr std::size_t kLeastAddresses = std::size_t{1} << 36;
constexpr std::size_t kHead = 64;  // bytes before a block that say how long its mapping is; to
                                   // their multiples it is aligned
constexpr std::uint64_t kTouched = 8'000'000;  // bytes that threads may touch between two looks
constexpr long kInterval = 250'000;            // ns, between two looks
const int kSignal = SIGRTMIN;

// `new` knows nothing but the size, so these are the program's: where large blocks go (0: nowhere,
// no PagedMemory lives), and the addresses that are theirs.
std::atomic<int> files_folder{0};
std::atomic<std::uintptr_t> first_address{0}, next_address{0};
std::uintptr_t end_address = 0;

// What a signal's handler may look at.
std::atomic<int> statm{-1};
std::atomic<std::uint64_t> most_pages{0};
std::atomic_flag looking = ATOMIC_FLAG_INIT;

std::size_t whole_pages(std::size_t bytes) {
    const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    return (bytes + page - 1) / page * page;
}

/// Addresses that nothing else gets. Kept to the program's end: blocks outlive PagedMemory.
void reserve_addresses() {
    if (first_address != 0) return;
    for (std::size_t size = kMostAddresses; size >= kLeastAddresses; size /= 4) {
        void* found =
            ::mmap(nullptr, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (found == MAP_FAILED) continue;
        next_address = reinterpret_cast<std::uintptr_t>(found);
        end_address = next_address + size;
        first_address = next_address.load();
        return;
    }
    throw Error(ExitCode::kBudget,
                "the system leaves no addresses (ulimit -v) for what does not fit into "
                "--memory-limit; give more of either");
}

/// A block in a file without a name; null where there is no disk or no address for it.
void* allocate_paged(std::size_t bytes) noexcept {
    const std::size_t size = whole_pages(bytes + kHead);
    const std::uintptr_t place = next_address.fetch_add(size);
    if (size < bytes || size > end_address || place > end_address - size) return nullptr;
    const int file = ::openat(files_folder, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0) return nullptr;
    // Without its room on the disk, writing to a page would be a signal instead of an error.
    const bool has_room = ::posix_fallocate(file, 0, static_cast<off_t>(size)) == 0;
    void* found = has_room ? ::mmap(reinterpret_cast<void*>(place), size, PROT_READ | PROT_WRITE,
                                    MAP_SHARED | MAP_FIXED, file, 0)
                           : MAP_FAILED;
    ::close(file);
    if (found == MAP_FAILED) return nullptr;
    *static_cast<std::size_t*>(found) = size;
    return static_cast<char*>(found) + kHead;
}

bool is_paged(void* block) noexcept {
    const auto address = reinterpret_cast<std::uintptr_t>(block);
    return first_address != 0 && address >= first_address && address < end_address;
}

void release_paged(void* block) noexcept {
    void* mapping = static_cast<char*>(block) - kHead;
    const std::size_t size = *static_cast<std::size_t*>(mapping);
    ::mmap(mapping, size, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE | MAP_FIXED, -1,
           0);
}

/// Lets the system take back the pages of all large blocks; nothing that they hold is lost.
void forget_pages_of_blocks() {
    ::madvise(reinterpret_cast<void*>(first_address.load()), next_address - first_address,
              MADV_DONTNEED);
}

/// Pages that the program occupies, without what resident_bytes may not do in a signal's handler.
std::uint64_t resident_pages() {
    char text[64];
    const ssize_t size = ::pread(statm, text, sizeof(text) - 1, 0);
    if (size <= 0) return 0;
    text[size] = '\0';
    char* second = nullptr;
    std::strtoull(text, &second, 10);
    return std::strtoull(second, nullptr, 10);
}

/// In whichever thread runs: it has touched pages since it looked last, so it looks again. While
/// one gives pages back the others wait, or they would touch as many meanwhile.
void look_at_memory(int) {
    const int error = errno;
    while (looking.test_and_set())
        ::sched_yield();
    if (resident_pages() >= most_pages) {
        forget_pages_of_blocks();
        forget_mapped_pages();
    }
    looking.clear();
    errno = error;
}

/// Interrupts the thread it was made by, as long as that runs. A thread that watches the others
/// would get its turn too late where they are many.
class Interruption {
  public:
    Interruption() {
        sigevent event{};
        event.sigev_notify = SIGEV_THREAD_ID;
        event.sigev_signo = kSignal;
        event._sigev_un._tid = ::gettid();
        made_ = ::timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0;
    }
    ~Interruption() {
        if (made_) ::timer_delete(timer_);
    }
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;

    void set(long nanoseconds) const {
        const itimerspec every{{0, nanoseconds}, {0, nanoseconds}};
        if (made_) ::timer_settime(timer_, 0, &every, nullptr);
    }

  private:
    timer_t timer_{};
    bool made_ = false;
};

void interrupt_this_thread(long nanoseconds) {
    thread_local const Interruption interruption;
    interruption.set(nanoseconds);
}

}  // namespace

/// Every thread while it works.
class PagedMemory::Threads : public tbb::task_scheduler_observer {
  public:
    Threads() {
        interrupt_this_thread(kInterval);
        observe();
    }
    ~Threads() override {
        observe(false);
        interrupt_this_thread(0);
    }
    void on_scheduler_entry(bool) override { interrupt_this_thread(kInterval); }
    void on_scheduler_exit(bool is_worker) override {
        if (is_worker) interrupt_this_thread(0);
    }
};

PagedMemory::PagedMemory(const std::filesystem::path& folder, std::uint64_t limit) {
    reserve_addresses();
    const int opened = ::open(folder.c_str(), O_DIRECTORY | O_RDONLY | O_CLOEXEC);
    const int file = opened < 0 ? -1 : ::openat(opened, ".", O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (file < 0) {
        if (opened >= 0) ::close(opened);
        throw Error(ExitCode::kBudget, "'" + folder.string() +
                                           "' cannot hold what does not fit into --memory-limit: "
                                           "its file system has no files without a name; choose "
                                           "another --temp-dir or give more memory");
    }
    ::close(file);
    files_folder = opened;
    statm = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    most_pages = (limit - std::min(limit, limit / 8 + kTouched)) /
                 static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action = {};
    action.sa_handler = look_at_memory;
    action.sa_flags = SA_RESTART;
    ::sigaction(kSignal, &action, nullptr);
    threads_ = std::make_unique<Threads>();
}

PagedMemory::~PagedMemory() {
    threads_.reset();
    std::signal(kSignal, SIG_IGN);  // one may be on its way
    ::close(statm.exchange(-1));
    ::close(files_folder.exchange(0));
}

}  // namespace glowworm

// NOLINTBEGIN(misc-new-delete-overloads): the forms left out call these.
void* operator new(std::size_t bytes, std::align_val_t alignment) {
    using namespace glowworm;
    const auto aligned = static_cast<std::size_t>(alignment);
    void* block = nullptr;
    if (bytes >= kLarge && aligned <= kHead && files_folder != 0) {
        block = allocate_paged(bytes);
    } else if (aligned <= alignof(std::max_align_t)) {
        block = std::malloc(std::max<std::size_t>(bytes, 1));
    } else if (::posix_memalign(&block, aligned, bytes) != 0) {
        block = nullptr;
    }
    if (block == nullptr) throw std::bad_alloc();
    return block;
}

void* operator new(std::size_t bytes) {
    return ::operator new (bytes, std::align_val_t{alignof(std::max_align_t)});
}

void operator delete(void* block) noexcept {
    if (glowworm::is_paged(block)) {
        glowworm::release_paged(block);
    } else {
        std::free(block);
    }
}

void operator delete(void* block, std::size_t) noexcept {
    ::operator delete(block);
}

void operator delete(void* block, std::align_val_t) noexcept {
    ::operator delete(block);
}

void operator delete(void* block, std::size_t, std::align_val_t) noexcept {
    ::operator delete(block);
}
// NOLINTEND(misc-new-delete-overloads)
