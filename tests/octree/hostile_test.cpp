#include <fstream>
#include <iterator>
#include <random>

#include "clouds.h"
#include "octree/build.h"
#include "octree_harness.h"
#include "testing.h"

namespace glowworm {
namespace {

/// GLOWWORM_MUTATIONS sets the number; the full run under the sanitizers takes 100000.
int mutations() {
    const char* wanted = std::getenv("GLOWWORM_MUTATIONS");
    return wanted != nullptr ? std::atoi(wanted) : 5000;
}

TEST(HostileOctree, RandomMutationsOfASmallFileAreRefusedOrHarmless) {
    const testing::ScratchFolder folder;
    const Octree octree = build_octree(testing::random_cloud(40, 0.05f), {.depth = 3});
    write_octree_file(octree.view(), folder / "a.svo");
    std::ifstream stream(folder / "a.svo", std::ios::binary);
    const std::vector<unsigned char> whole{std::istreambuf_iterator<char>(stream), {}};
    ASSERT_TRUE(testing::try_octree_bytes(whole));

    // Most damage goes where something lies: the header, the sections' first bytes.
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        if (whole[i] != 0 || i < sizeof(FileHeader)) places.push_back(i);
    }
    std::mt19937 random(7);
    int opened = 0;
    for (int trial = 0; trial < mutations(); ++trial) {
        std::vector<unsigned char> bytes = whole;
        for (auto changes = 1 + random() % 4; changes > 0; --changes) {
            const std::size_t at = places[random() % places.size()];
            const unsigned char values[] = {0,
                                            1,
                                            0x7f,
                                            0x80,
                                            0xff,
                                            static_cast<unsigned char>(bytes[at] + 1),
                                            static_cast<unsigned char>(random())};
            bytes[at] = values[random() % 7];
        }
        if (random() % 20 == 0) bytes.resize(random() % bytes.size());
        opened += testing::try_octree_bytes(bytes);
    }
    EXPECT_GT(opened, mutations() / 10) << "the mutations must reach past the header";
    EXPECT_LT(opened, mutations());
}

TEST(HostileOctree, EveryTruncationIsRefusedOrHarmless) {
    const testing::ScratchFolder folder;
    const Octree octree = build_octree(testing::random_cloud(12, 0.05f), {.depth = 2});
    write_octree_file(octree.view(), folder / "a.svo");
    std::ifstream stream(folder / "a.svo", std::ios::binary);
    const std::vector<unsigned char> whole{std::istreambuf_iterator<char>(stream), {}};
    for (std::size_t size = whole.size(); size-- > 0;) {
        std::filesystem::resize_file(folder / "a.svo", size);
        ASSERT_THROW(OctreeFile::open(folder / "a.svo"), Error) << size;
        // With a header that owns up to the new length.
        if (size % 3 == 0) testing::try_octree_bytes(std::span(whole).first(size));
    }
}

}  // namespace
}  // namespace glowworm
