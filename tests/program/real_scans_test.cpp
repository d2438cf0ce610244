// The whole way on real scans, as users run it: without colour, with and without a station.

#include <nlohmann/json.hpp>

#include "program.h"
#include "testing.h"
#include "viewer/frame/exr.h"

namespace glowworm::testing {
namespace {

using Json = nlohmann::json;

/// Converts `scans` and renders what a viewer opens on, returning what convert said.
Json convert_and_look(const std::filesystem::path& scans) {
    const ScratchFolder folder;
    const std::string svo = folder / "cave.svo", frame = folder / "frame.exr";
    const Ended converted = glowworm({"convert", scans, "-o", svo, "--json", "--links", "16"});
    EXPECT_EQ(converted.code, 0) << converted.err;
    if (converted.code != 0) return {};
    EXPECT_THAT(converted.err, ::testing::HasSubstr("albedo from"));
    EXPECT_EQ(glowworm({"check", svo}).code, 0);

    const Ended viewed =
        glowworm_view({svo, "--headless", "--size", "80x60", "--bounces", "4", "-o", frame});
    EXPECT_EQ(viewed.code, 0) << viewed.err;
    std::size_t lit = 0;
    const std::vector<float> green = read_exr(frame).channels.at("G");
    for (const float value : green) lit += value > 0.0f ? 1 : 0;
    const double share = double(lit) / double(green.size());
    std::printf("%s: %.0f %% of the picture is lit\n", scans.filename().c_str(), 100.0 * share);
    EXPECT_GT(share, 0.5);
    return Json::parse(converted.out);
}

TEST(RealScans, FourScansOfOneSiteFindEachOther) {
    GLOWWORM_DATA_OR_SKIP(data);
    const Json result = convert_and_look(data / "obs_eq_tls");
    EXPECT_EQ(result["scans"], 4);
    EXPECT_EQ(result["registered"], 4);
}

TEST(RealScans, AHandheldScanOfAMineDriftHasNoStationAndConvertsAllTheSame) {
    GLOWWORM_DATA_OR_SKIP(data);
    const Json result = convert_and_look(data / "mine_pcr");
    EXPECT_EQ(result["scans"], 1);
    EXPECT_EQ(result["surface"]["orientation"], "propagation");
}

}  // namespace
}  // namespace glowworm::testing
