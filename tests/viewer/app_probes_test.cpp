#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "octree/error.h"
#include "testing.h"
#include "viewer/app/probes.h"

namespace glowworm {
namespace {

ProbeTable read_text(const std::string& text) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "probes.csv", std::ios::binary) << text;
    return read_probes(folder / "probes.csv");
}

TEST(Probes, AreReadWhateverTheOrderOfTheirColumns) {
    const ProbeTable table = read_text("id,nz,ny,nx,pz,py,px\r\na,2,0,0,3,2.5,-1e0\r\n");
    ASSERT_EQ(table.probes.size(), 1u);
    EXPECT_EQ(table.probes[0].position, (Vec3d{-1, 2.5, 3}));
    EXPECT_EQ(table.probes[0].normal, (Vec3d{0, 0, 1}));
}

TEST(Probes, CarryOtherColumnsThroughAndPassOverTruth) {
    const ProbeTable table =
        read_text("px,py,pz,nx,ny,nz,E_direct_r,note\n1,2,3,0,0,1,99,\"a, b\"\n4,5,6,1,0,0,98,c\n");
    EXPECT_TRUE(table.truth.empty()) << "one truth column is no truth";
    const std::vector<Irradiance> measured = {{{1, 2, 3}, {4, 5, 6}}, {{0, 0, 0}, {0.5f, 0, 0}}};
    EXPECT_EQ(format_probes(table, measured),
              "px,py,pz,nx,ny,nz,note,E_direct_r,E_direct_g,E_direct_b,E_indirect_r,E_indirect_g,"
              "E_indirect_b\n"
              "1,2,3,0,0,1,\"a, b\",1,2,3,4,5,6\n"
              "4,5,6,1,0,0,c,0,0,0,0.5,0,0\n");
}

TEST(Probes, AreComparedWithTheTruthTheyBring) {
    const ProbeTable table = read_text(
        "px,py,pz,nx,ny,nz,E_direct_r,E_direct_g,E_direct_b,E_indirect_r,E_indirect_g,E_indirect_"
        "b\n"
        "0,0,0,0,0,1,1,1,1,2,2,2\n");
    const std::vector<Irradiance> measured = {{{1.1f, 1, 1}, {2, 2, 2.4f}}};
    const auto differences = compare_probes(table, measured);
    ASSERT_TRUE(differences);
    EXPECT_NEAR(differences->direct.mean, 0.1 / 3, 1e-6);
    EXPECT_NEAR(differences->direct.worst, 0.1, 1e-6);
    EXPECT_NEAR(differences->indirect.worst, 0.2, 1e-6);
    EXPECT_FALSE(compare_probes(read_text("px,py,pz,nx,ny,nz\n0,0,0,0,0,1\n"), measured));
}

TEST(Probes, AreRefusedWithTheLineThatIsWrong) {
    const struct {
        const char* text;
        const char* says;
        ExitCode code;
    } cases[] = {
        {"", "is empty", ExitCode::kDegenerate},
        {"px,py,pz,nx,ny,nz\n", "has no probes", ExitCode::kDegenerate},
        {"px,py,pz,nx,ny\n1,2,3,4,5\n", "no column 'nz'", ExitCode::kUnreadable},
        {"px,py,pz,nx,ny,nz,px\n1,2,3,0,0,1,9\n", "two columns 'px'", ExitCode::kUnreadable},
        {"px,py,pz,nx,ny,nz\n1,2,3,0,0,1\n1,2\n", "line 3 has 2 cells", ExitCode::kUnreadable},
        {"px,py,pz,nx,ny,nz\n1,2,nan,0,0,1\n", "line 2: 'nan'", ExitCode::kUnreadable},
        {"px,py,pz,nx,ny,nz\n1,2,3m,0,0,1\n", "'3m'", ExitCode::kUnreadable},
        {"px,py,pz,nx,ny,nz\n1,2,3,0,0,0\n", "normal is zero", ExitCode::kUnreadable},
    };
    for (const auto& c : cases) {
        try {
            read_text(c.text);
            ADD_FAILURE() << "accepted: " << c.text;
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), c.code) << c.text;
            EXPECT_THAT(error.what(), ::testing::HasSubstr(c.says));
        }
    }
}

}  // namespace
}  // namespace glowworm
