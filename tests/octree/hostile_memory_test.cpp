// Its own program, because it counts what every `new` in it takes.

#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <new>
#include <random>

#include "clouds.h"
#include "octree/build.h"
#include "octree_harness.h"
#include "testing.h"

namespace {

std::atomic<std::size_t> held{0}, peak{0};

void* take(std::size_t bytes) {
    void* memory = std::malloc(bytes);
    if (memory == nullptr) throw std::bad_alloc();
    const std::size_t now = held += ::malloc_usable_size(memory);
    for (std::size_t most = peak; now > most && !peak.compare_exchange_weak(most, now);) {
    }
    return memory;
}

void give_back(void* memory) {
    held -= ::malloc_usable_size(memory);
    std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) {
    return take(bytes);
}
void operator delete(void* memory) noexcept {
    give_back(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    give_back(memory);
}

namespace glowworm {
namespace {

TEST(HostileOctree, TakesAtMostTwiceItsSizeInMemory) {
    const testing::ScratchFolder folder;
    const Octree octree = build_octree(testing::random_cloud(1500, 0.05f), {.depth = 5});
    write_octree_file(octree.view(), folder / "a.svo");
    std::ifstream stream(folder / "a.svo", std::ios::binary);
    const std::vector<unsigned char> whole{std::istreambuf_iterator<char>(stream), {}};

    std::mt19937 random(11);
    double worst = 0.0;
    int opened = 0;
    for (int trial = 0; trial < 100; ++trial) {
        std::vector<unsigned char> bytes = whole;
        // Headers and counts above all: they are what memory is asked for by.
        const std::size_t reach = trial % 2 == 0 ? 8192 : bytes.size();
        for (int changes = trial == 0 ? 0 : 3; changes > 0; --changes)
            bytes[random() % reach] = static_cast<unsigned char>(random());
        const std::size_t before = held;
        peak = before;
        opened += testing::try_octree_bytes(bytes);
        // The harness holds the bytes once itself.
        const double taken = static_cast<double>(peak - before) / static_cast<double>(bytes.size());
        worst = std::max(worst, taken - 1.0);
    }
    EXPECT_GT(opened, 30);
    EXPECT_LT(worst, 2.0) << "times the file's size";
    std::printf("at most %.2f times the file's size, of %zu bytes\n", worst, whole.size());
}

}  // namespace
}  // namespace glowworm
