#include "octree/pack.h"

#include <limits>
#include <random>

#include "clouds.h"
#include "octree/morton.h"
#include "octree/radix_sort.h"
#include "testing.h"

namespace glowworm {
namespace {

TEST(Morton, DecodeIsTheInverseOfEncode) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 10000; ++i) {
        const std::uint64_t code = random() >> 1;
        EXPECT_EQ(morton_encode(morton_decode(code)), code);
    }
    EXPECT_EQ(morton_encode({0x1fffff, 0, 0}), 0x1249249249249249u);
}

TEST(Morton, EveryBitStandsWhereTheLoopPutsIt) {
    std::mt19937 random(2);
    for (int i = 0; i < 1000; ++i) {
        const auto axis = [&] { return static_cast<std::uint32_t>(random() & 0x1fffff); };
        const CellIndex cell{axis(), axis(), axis()};
        std::uint64_t code = 0;
        for (int bit = 0; bit < 21; ++bit) {
            code |= std::uint64_t{cell.x >> bit & 1} << (3 * bit) |
                    std::uint64_t{cell.y >> bit & 1} << (3 * bit + 1) |
                    std::uint64_t{cell.z >> bit & 1} << (3 * bit + 2);
        }
        EXPECT_EQ(morton_encode(cell), code);
    }
}

TEST(RadixSort, EqualsAStableSort) {
    std::mt19937_64 random(3);
    for (const std::uint64_t mask : {~0ull >> 1, 0xffull, 0xff0000ff000000ull, 0ull}) {
        CodeIndices entries(300000);
        for (std::uint32_t i = 0; i < entries.size(); ++i)
            entries[i] = {random() & mask, i, i * 7};
        CodeIndices truth = entries;
        std::stable_sort(truth.begin(), truth.end(),
                         [](const CodeIndex& a, const CodeIndex& b) { return a.code < b.code; });
        radix_sort(entries);
        for (std::size_t i = 0; i < truth.size(); ++i) {
            ASSERT_EQ(entries[i].code, truth[i].code);
            ASSERT_EQ(entries[i].index, truth[i].index);
            ASSERT_EQ(entries[i].part, truth[i].part);
        }
    }
}

TEST(Pack, NormalsComeBackWithinFourThousandthsOfADegree) {
    std::mt19937 random(4);
    double worst = 0.0;
    for (int i = 0; i < 100000; ++i) {
        const Vec3f n = testing::random_direction(random);
        const Vec3f back = unpack_octahedral(pack_octahedral(n));
        worst = std::max(worst, length(vec3_cast<double>(n) - vec3_cast<double>(back)));
    }
    for (const Vec3f& axis : {Vec3f{0, 0, -1}, Vec3f{0, -1, 0}, Vec3f{-1, 0, 0}}) {
        EXPECT_LT(length(unpack_octahedral(pack_octahedral(axis)) - axis), 1e-6f);
    }
    EXPECT_LT(worst * 180.0 / std::numbers::pi, 0.004);
}

TEST(Pack, EveryHalfComesBackAndOthersRoundToTheNearest) {
    for (std::uint32_t bits = 0; bits < 0x7c00; ++bits) {
        const auto half = static_cast<std::uint16_t>(bits);
        ASSERT_EQ(pack_half(unpack_half(half)), half);
        const auto next = static_cast<std::uint16_t>(bits + 1);
        if (next >= 0x7c00) continue;
        const float low = unpack_half(half), high = unpack_half(next);
        ASSERT_LT(low, high);
        ASSERT_EQ(pack_half(low + 0.49f * (high - low)), half);
        ASSERT_EQ(pack_half(low + 0.51f * (high - low)), next);
    }
    EXPECT_EQ(pack_half(1.0f), 0x3c00);
    EXPECT_EQ(pack_half(-2.0f), 0xc000);
    EXPECT_EQ(unpack_half(pack_half(1e9f)), 65504.0f);
    EXPECT_EQ(pack_half(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Pack, EverySrgbCodeComesBackAndOthersRoundToTheNearestCode) {
    for (int code = 0; code < 256; ++code) {
        const auto byte = static_cast<std::uint8_t>(code);
        EXPECT_EQ(pack_srgb8(unpack_srgb8(byte)), byte);
    }
    for (float linear = 0.0f; linear <= 1.0f; linear += 1.0f / 70001.0f) {
        const float encoded = linear_to_srgb(linear) * 255.0f;
        ASSERT_LE(std::abs(encoded - static_cast<float>(pack_srgb8(linear))), 0.501f) << linear;
    }
    EXPECT_EQ(pack_srgb8(-1.0f), 0);
    EXPECT_EQ(pack_srgb8(2.0f), 255);
    EXPECT_EQ(pack_srgb8(std::numeric_limits<float>::quiet_NaN()), 0);
}

TEST(Pack, Rgb9e5ErrsByLessThanHalfAStepOfItsLargestChannel) {
    std::mt19937 random(6);
    std::uniform_real_distribution<float> exponent(-12.0f, 15.0f), unit(0.0f, 1.0f);
    double worst = 0.0;
    for (int i = 0; i < 100000; ++i) {
        const float scale = std::exp2(exponent(random));
        const Vec3f c{unit(random) * scale, unit(random) * scale, unit(random) * scale};
        const Vec3f back = unpack_rgb9e5(pack_rgb9e5(c));
        const float largest = std::max({c.x, c.y, c.z});
        for (int k = 0; k < 3; ++k) {
            worst = std::max(worst, static_cast<double>(std::abs(back[k] - c[k]) / largest));
        }
    }
    EXPECT_LE(worst, 1.0 / 511.0);
    EXPECT_EQ(pack_rgb9e5({}), 0u);
    EXPECT_EQ(unpack_rgb9e5(pack_rgb9e5({1e9f, 1.0f, -3.0f})), (Vec3f{65408.0f, 0.0f, 0.0f}));
    EXPECT_EQ(unpack_rgb9e5(pack_rgb9e5({12.0f, 6.0f, 3.0f})), (Vec3f{12.0f, 6.0f, 3.0f}));
    EXPECT_EQ(unpack_rgb9e5(pack_rgb9e5({0.9999f, 0.0f, 0.0f})), (Vec3f{1.0f, 0.0f, 0.0f}));
}

}  // namespace
}  // namespace glowworm
