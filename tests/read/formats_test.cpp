#include <array>
#include <set>

#include "scan_text.h"

namespace glowworm {
namespace {

struct Truth {
    const char* file;      // below data/formats
    std::uint64_t points;  // 0: refused
    Vec3d low, high;       // m
    std::array<std::uint64_t, 3>
        colours{};  // sum of each channel over the points, 0 without colour
};

// Counts, bounds and colours worked out from the files by a script that shares nothing with the
// readers. The scans of a file are taken together.
const Truth kTruths[] = {
    {"../mine_pcr/2025-04-21-11-04-46.pcd",
     176758,
     {-22.2603817, -96.68296814, -128.1380005},
     {108.4089432, 15.07370567, 4.074558258},
     {}},
    {"../pcl_data/region_growing_tutorial.pcd",
     108104,
     {-3838.340088, 4065.570068, 12775.75977},
     {1366.670044, 11727.0498, 14681.12988},
     {10608881, 14604616, 14772861}},
    {"../pcl_data/room_scan1.pcd",
     112586,
     {-13.79977989, -6.492819786, -1.351704955},
     {15.44711018, 7.979565144, 1.709092975},
     {}},
    {"assimp/invalid/empty.ply", 0, {}, {}, {}},
    {"loaders.gl/cpp/Model3DTiler/test/resources/ripple_ascii.ply",
     10201,
     {-5, -5, -0.66641},
     {5, 5, 1.1},
     {302999, 1370248, 565336}},
    {"loaders.gl/cpp/Model3DTiler/test/resources/ripple_bin.ply",
     10201,
     {-5, -5, -0.6664100289},
     {5, 5, 1.100000024},
     {302999, 1370248, 565336}},
    {"loaders.gl/modules/pcd/test/data/simple-ascii.pcd",
     213,
     {-0.95526, -0.31546, 0},
     {0.99185, 0.35641, 0},
     {29154, 33354, 37632}},
    {"open3d_pts/point_cloud_sample1.pts",
     10,
     {-9.318283, -14.000992, -65.560776},
     {4.246445, -6.014053, -50.214615},
     {800, 727, 957}},
    {"pcl_test/colored_cloud.pcd",
     1000,
     {-0.8871009946, -0.6507353187, 0.8820000291},
     {0.4887999892, -0.3754895926, 1.531999946},
     {140634, 139284, 136778}},
    {"pdal/pcd/utm17_comma.pcd",
     10,
     {289814.15, 4320978.61, 170.58},
     {289818.5, 4320980.59, 170.76},
     {}},
    {"pdal/pcd/utm17_space.pcd",
     10,
     {289814.15, 4320978.61, 170.58},
     {289818.5, 4320980.59, 170.76},
     {}},
    {"pdal/pcd/utm17_tab.pcd",
     10,
     {289814.15, 4320978.61, 170.58},
     {289818.5, 4320980.59, 170.76},
     {}},
    {"pdal/ply/issue_2421.ply",
     1,
     {1.23457, 12345.6789, 1234567890.12345},
     {1.23457, 12345.6789, 1234567890.12345},
     {}},
    {"pdal/ply/mesh.ply", 4, {1, 1, 0}, {2, 2, 2}, {}},
    {"pdal/ply/mesh_fixed.ply", 4, {1, 1, 0}, {2, 2, 2}, {}},
    {"pdal/ply/no_vertex.ply", 0, {}, {}, {}},
    {"pdal/ply/simple_binary.ply", 3, {-1, 0, 0}, {1, 1, 0}, {}},
    {"pdal/ply/simple_text.ply", 3, {-1, 0, 0}, {1, 1, 0}, {}},
    {"pdal/ply/sized_dims.ply", 0, {}, {}, {}},
    {"pdal/ply/text_extradim.ply",
     1,
     {-2.64944, -13.0955, 0.00640115},
     {-2.64944, -13.0955, 0.00640115},
     {63, 200, 64}},
    {"pdal/ply/unsized_dims.ply", 0, {}, {}, {}},
    {"pdal/pts/autzen.pts",
     10,
     {636102.84, 848968.8, 427.919998},
     {636126.4, 849345.2, 512.139999},
     {1019, 1157, 923}},
    {"pdal/pts/bunny_8.pts",
     9,
     {-0.068009, 0.112568, 0.001795},
     {0.033213, 0.151244, 0.037195},
     {}},
    {"pdal/pts/site_56_8.pts",
     8,
     {6691.250667, 17.347517, -14.709473},
     {6728.512429, 45.710979, 1203.033447},
     {}},
    {"pdal/pts/test.pts",
     19,
     {-25.050461, -24.533554, -2.000961},
     {3.980972, -2.006119, -0.010086},
     {443, 312, 254}},
    {"pdal/ptx/1.2-with-color.ptx",
     1065,
     {635619.85, 848899.7, 406.59},
     {638982.55, 853535.43, 586.38},
     {129567, 118582, 134764}},
    {"pdal/ptx/multiple-and-transform.ptx",
     8,
     {636699.38, 848991.01, 425.39},
     {637012.24, 849106.66, 446.39},
     {}},
    {"pdal/ptx/no-color.ptx",
     15,
     {635795.24, 848991.01, 408.6},
     {637012.24, 849390.78, 446.39},
     {}},
    {"pdal/text/badheader.txt", 0, {}, {}, {}},
    {"pdal/text/crlf_test.txt",
     10,
     {289814.15, 4320978.61, 170.58},
     {289818.5, 4320980.59, 170.76},
     {}},
    {"pdal/text/missingheader.txt", 5, {1, 1, 1}, {5, 5, 5}, {}},
    {"pdal/text/quoted.txt", 9, {0, 1, 2}, {29, 25, 2}, {}},
    {"pdal/text/utm17_1.txt",
     10,
     {289814.15, 4320978.61, 170.58},
     {289818.5, 4320980.59, 170.76},
     {}},
    {"pdal/text/utm17_2.txt",
     10,
     {289814.15, 4320978.61, 170.58},
     {289818.5, 4320980.59, 170.76},
     {}},
    {"pyntcloud/diamond.ply", 6, {0, 0, 0}, {1, 1, 1}, {1020, 255, 255}},
    {"pyntcloud/diamond_ascii.ply", 6, {0, 0, 0}, {1, 1, 1}, {1020, 255, 255}},
    {"pyntcloud/diamond_ascii_vertex_index.ply", 6, {0, 0, 0}, {1, 1, 1}, {1020, 255, 255}},
    {"pyntcloud/diamond_with_bool.ply", 6, {0, 0, 0}, {1, 1, 1}, {1020, 255, 255}},
};

struct Found {
    std::uint64_t points = 0;
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    std::array<std::uint64_t, 3> colours{};
};

Found found_in(const std::vector<Scan>& scans) {
    Found found;
    for (const Scan& scan : scans) {
        found.points += scan.points.size();
        for (const Vec3f& p : scan.points.positions) {
            const Vec3d world = scan.offset + vec3_cast<double>(p);
            found.low = component_min(found.low, world);
            found.high = component_max(found.high, world);
        }
        for (const Rgb8& c : scan.points.colours) {
            found.colours[0] += c.r;
            found.colours[1] += c.g;
            found.colours[2] += c.b;
        }
    }
    return found;
}

double error_of(const Truth& truth, const Found& found) {
    const Vec3d low = found.low - truth.low, high = found.high - truth.high;
    double error = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        error = std::max({error, std::abs(low[axis]), std::abs(high[axis])});
    return error;
}

TEST(Formats, EveryTextPlyAndPcdFileHoldsWhatItsHeaderOrTwinStates) {
    GLOWWORM_DATA_OR_SKIP(data);
    for (const Truth& truth : kTruths) {
        const std::filesystem::path path = data / "formats" / truth.file;
        if (truth.points == 0) {
            const auto outcome = testing::outcome_of_reading(path);
            std::printf("%-60s exit %d: %s\n", truth.file, static_cast<int>(outcome.code),
                        outcome.sentence.c_str());
            EXPECT_TRUE(outcome.code == ExitCode::kUnreadable ||
                        outcome.code == ExitCode::kDegenerate)
                << truth.file;
            EXPECT_NE(outcome.sentence.find(path.string()), std::string::npos);
            continue;
        }
        ReadReport report;
        const Found found = found_in(read_scans(path, {}, &report));
        const double error = error_of(truth, found);
        std::printf("%-60s %s %s: %zu points, bounds off by %.2g m\n", truth.file,
                    report.format.name.c_str(), report.format.version.c_str(),
                    static_cast<std::size_t>(found.points), error);
        EXPECT_EQ(found.points, truth.points) << truth.file;
        EXPECT_EQ(found.colours, truth.colours) << truth.file;
        // Bounds span at most some kilometres around the offset, where float's step is 0.3 mm.
        EXPECT_LT(error, 3e-4) << truth.file;
    }
}

TEST(Formats, NoFileOfTheseKindsIsLeftOut) {
    GLOWWORM_DATA_OR_SKIP(data);
    std::set<std::filesystem::path> known;
    for (const Truth& truth : kTruths)
        known.insert((data / "formats" / truth.file).lexically_normal());
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data / "formats")) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".ply" && extension != ".pcd" && extension != ".pts" &&
            extension != ".ptx" && extension != ".txt") {
            continue;
        }
        EXPECT_TRUE(known.contains(entry.path().lexically_normal())) << entry.path();
    }
}

}  // namespace
}  // namespace glowworm
