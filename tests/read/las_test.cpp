#include <cmath>
#include <random>

#include "hostile.h"
#include "las_bytes.h"
#include "preprocess/read/las_records.h"
#include "preprocess/read/little_endian.h"
#include "preprocess/read/scan_file.h"

namespace glowworm::testing {
namespace {

LasContent some_points(int minor, int format, std::size_t count) {
    LasContent content;
    content.minor = minor;
    content.format = format;
    std::mt19937 random(3);
    for (std::size_t i = 0; i < count; ++i) {
        LasPoint point;
        point.x = static_cast<std::int32_t>(random() % 20000) - 10000;
        point.y = static_cast<std::int32_t>(random() % 20000) - 10000;
        point.z = static_cast<std::int32_t>(random() % 20000) - 10000;
        point.intensity = static_cast<std::uint16_t>(random());
        point.time = 1.5e5 + 0.25 * static_cast<double>(i);
        point.red = static_cast<std::uint16_t>(random() | 0x8000);
        point.green = static_cast<std::uint16_t>(random());
        point.blue = static_cast<std::uint16_t>(random());
        content.points.push_back(point);
    }
    return content;
}

TEST(Las, EveryVersionAndPointFormatGivesItsPoints) {
    constexpr int kOldestMinor[] = {0, 0, 2, 2, 3, 3, 4, 4, 4, 4, 4};
    for (int format = 0; format <= 10; ++format) {
        for (int minor = kOldestMinor[format]; minor <= 4; ++minor) {
            SCOPED_TRACE("1." + std::to_string(minor) + " format " + std::to_string(format));
            const LasContent content = some_points(minor, format, 50);
            const std::vector<Scan> scans = scans_from(las_file(content));
            ASSERT_EQ(scans.size(), 1u);
            const Points& points = scans[0].points;
            ASSERT_EQ(points.size(), content.points.size());
            const bool timed = format == 1 || format >= 3;
            const bool coloured = format == 2 || format == 3 || format == 5 || format == 7 ||
                                  format == 8 || format == 10;
            EXPECT_EQ(points.times.size(), timed ? 50u : 0u);
            EXPECT_EQ(points.colours.size(), coloured ? 50u : 0u);
            EXPECT_FALSE(scans[0].T_world_scan.has_value());
            for (std::size_t i = 0; i < points.size(); ++i) {
                const LasPoint& truth = content.points[i];
                EXPECT_FLOAT_EQ(points.positions[i].x, static_cast<float>(truth.x * 0.001));
                EXPECT_FLOAT_EQ(points.positions[i].y, static_cast<float>(truth.y * 0.001));
                EXPECT_FLOAT_EQ(points.positions[i].z, static_cast<float>(truth.z * 0.001));
                EXPECT_EQ(points.intensities[i], truth.intensity);
                EXPECT_TRUE(!timed || points.times[i] == truth.time);
                if (coloured) {
                    const Rgb8 high_bytes{static_cast<std::uint8_t>(truth.red >> 8),
                                          static_cast<std::uint8_t>(truth.green >> 8),
                                          static_cast<std::uint8_t>(truth.blue >> 8)};
                    EXPECT_EQ(points.colours[i], high_bytes);
                }
            }
        }
    }
}

TEST(Las, EightBitColoursInSixteenBitFieldsAreRecognisedWhereverTheyLie) {
    LasContent content = some_points(2, 2, 70000);
    for (std::size_t i = 0; i < content.points.size(); ++i) {
        LasPoint& point = content.points[i];
        // Black to begin with, so that the first points tell nothing.
        point.red = point.green = point.blue = i < 66000 ? 0 : 200;
    }
    EXPECT_EQ(scans_from(las_file(content))[0].points.colours.back(), (Rgb8{200, 200, 200}));
    for (std::size_t i = 66000; i < content.points.size(); ++i)
        content.points[i].red = 200 << 8;
    EXPECT_EQ(scans_from(las_file(content))[0].points.colours.back(), (Rgb8{200, 0, 0}));
}

TEST(Las, WithheldPointsAreLeftOutAndCounted) {
    for (const int format : {3, 7}) {
        LasContent content = some_points(4, format, 100);
        for (std::size_t i = 0; i < 100; i += 4)
            content.points[i].withheld = true;
        ReadReport report;
        const std::vector<Scan> scans = scans_from(las_file(content), {}, &report);
        EXPECT_EQ(scans[0].points.size(), 75u);
        EXPECT_EQ(report.scans[0].invalid, 25u);
        EXPECT_EQ(report.scans[0].declared, 100u);
        EXPECT_EQ(scans[0].points.intensities[0], content.points[1].intensity);
    }
}

TEST(Las, CoordinatesFarFromTheOriginKeepTheirMillimetres) {
    LasContent content = some_points(2, 0, 200);
    content.offset[0] = 431000.0;
    content.offset[1] = 5321000.0;
    const std::vector<Scan> scans = scans_from(las_file(content));
    double worst = 0.0;
    for (std::size_t i = 0; i < 200; ++i) {
        const Vec3d read = scans[0].offset + vec3_cast<double>(scans[0].points.positions[i]);
        worst = std::max(worst, std::abs(read.x - (431000.0 + content.points[i].x * 0.001)));
        worst = std::max(worst, std::abs(read.y - (5321000.0 + content.points[i].y * 0.001)));
    }
    EXPECT_LT(worst, 1e-5) << "worst error " << worst << " m";
}

TEST(Las, ExtraBytesNamedAsNormalsAreNormals) {
    LasContent content = some_points(4, 7, 20);
    std::string table;
    for (const char* name : {"NormalX", "NormalY", "NormalZ"}) {
        std::string entry(192, '\0');
        entry[2] = 9;  // float
        entry.replace(4, 7, name);
        table += entry;
    }
    content.records = las_record("LASF_Spec", 4, table);
    content.record_count = 1;
    content.extra.resize(12);
    put(content.extra, 0, 0.6f);
    put(content.extra, 4, 0.0f);
    put(content.extra, 8, -0.8f);
    const std::vector<Scan> scans = scans_from(las_file(content));
    ASSERT_EQ(scans[0].points.normals.size(), 20u);
    EXPECT_EQ(scans[0].points.normals[19], (Vec3f{0.6f, 0.0f, -0.8f}));
    EXPECT_EQ(scans[0].points.colours[19].r, content.points[19].red >> 8);
}

TEST(Las, TheReferenceSystemIsSaidInWords) {
    LasContent content = some_points(2, 0, 1);
    std::string keys(32, '\0');  // the directory's own four numbers, then three keys
    put(keys, 8, std::uint16_t{3072});
    put(keys, 14, std::uint16_t{32617});
    put(keys, 16, std::uint16_t{3073});
    put(keys, 18, std::uint16_t{34737});
    put(keys, 20, std::uint16_t{6});
    put(keys, 24, std::uint16_t{3076});
    put(keys, 30, std::uint16_t{9003});
    content.records = las_record("LASF_Projection", 34735, keys) +
                      las_record("LASF_Projection", 34737, "UTM 17|");
    content.record_count = 2;
    const ScratchFolder folder;
    ScanHeader header;
    open_scan_file(write_file(folder / "a", las_file(content)))->next_scan(header);
    EXPECT_EQ(header.crs, "UTM 17, EPSG:32617, unit US survey foot");

    content.records = las_record("LASF_Projection", 2112, "PROJCS[\"cave grid\"]");
    content.record_count = 1;
    open_scan_file(write_file(folder / "b", las_file(content)))->next_scan(header);
    EXPECT_EQ(header.crs, "PROJCS[\"cave grid\"]");
}

TEST(Las, AWrongNumberOfRecordsLeavesThePointsReadable) {
    LasContent content = some_points(2, 3, 10);
    content.record_count = 0xffffffffu;
    ReadReport report;
    EXPECT_EQ(scans_from(las_file(content), {}, &report)[0].points.size(), 10u);
    EXPECT_EQ(report.notes.size(), 1u);
}

TEST(Las, CountsThatLieAndSizesThatCannotBeAreRefused) {
    const std::string whole = las_file(some_points(4, 7, 10));
    const auto damaged = [&](std::size_t at, auto value) {
        std::string file = whole;
        put(file, at, value);
        return outcome_of(file);
    };
    for (const std::uint64_t count :
         {std::uint64_t{11}, std::uint64_t{1} << 31, ~std::uint64_t{0}, std::uint64_t{1} << 63}) {
        EXPECT_EQ(damaged(247, count).code, ExitCode::kUnreadable) << count;
    }
    EXPECT_EQ(damaged(247, std::uint64_t{0}).code, ExitCode::kDegenerate);
    EXPECT_EQ(damaged(25, std::uint8_t{5}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(94, std::uint16_t{100}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(96, std::uint32_t{0xffffffff}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(96, std::uint32_t{0}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(104, std::uint8_t{11}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(104, std::uint8_t{0x87}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(105, std::uint16_t{0}).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(131, 0.0).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(131, std::nan("")).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(155, HUGE_VAL).code, ExitCode::kUnreadable);
    EXPECT_EQ(damaged(235, ~std::uint64_t{0}).code, ExitCode::kDone);
}

TEST(Las, DamageIsRefusedOrReadButNeverMore) {
    LasContent content = some_points(4, 7, 5);
    content.records = las_record("LASF_Spec", 4, std::string(192, '\1'));
    content.record_count = 1;
    const std::string file = las_file(content);
    EXPECT_EQ(refused_when_cut(file), file.size());
    EXPECT_GT(refused_when_flipped(file, 24, 400), 100u);
    EXPECT_GT(refused_when_overwritten(file, 3), 10u);
}

/// All records of a file, every attribute decoded.
std::vector<std::byte> all_records(const std::filesystem::path& path, LasHeader& header) {
    const InputFile file(path);
    header = read_las_header(file);
    std::vector<std::byte> records(header.point_count * header.record_bytes);
    open_las_records(file, header, {})->read(records.data(), header.point_count);
    return records;
}

/// The box of all records, m.
void expect_bounds(const std::vector<std::byte>& records, const LasHeader& header) {
    for (int axis = 0; axis < 3; ++axis) {
        double least = HUGE_VAL, most = -HUGE_VAL;
        for (std::size_t at = 0; at < records.size(); at += header.record_bytes) {
            const double value =
                load<std::int32_t>(records.data() + at + 4 * axis) * header.scale[axis] +
                header.offset[axis];
            least = std::min(least, value);
            most = std::max(most, value);
        }
        EXPECT_NEAR(least, header.bounds_min[axis], 1e-6);
        EXPECT_NEAR(most, header.bounds_max[axis], 1e-6);
    }
}

TEST(Laz, CompressedFilesHoldTheRecordsOfTheirUncompressedTwins) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::filesystem::path formats = data / "formats";
    const std::pair<const char*, const char*> twins[] = {
        {"laspy/1_4_w_evlr.laz", "laspy/1_4_w_evlr.las"},
        {"laz-perf/point10.las.laz", "laz-perf/point10.las"},
        {"laz-perf/point10-1.0.laz", "laz-perf/point10-1.0.las"},
        {"laz-perf/point10-1.1.laz", "laz-perf/point10-1.1.las"},
        {"laz-perf/point-time.las.laz", "laz-perf/point-time.las"},
        {"laz-perf/point-time-1.4.las.laz", "laz-perf/point-time.las"},
        {"laz-perf/point-color.las.laz", "laz-perf/point-color.las"},
        {"laz-perf/point-color-time.las.laz", "laz-perf/point-color-time.las"},
        {"pdal/laz/simple.laz", "pdal/las/simple.las"},
        {"pdal/laszip/laszip-generated.laz", "pdal/las/simple.las"},
        {"pdal/laszip/laszip-generated_with2bytespadding.laz", "pdal/las/simple.las"},
        {"pdal/laszip/liblas-generated.laz", "pdal/las/simple.las"},
    };
    for (const auto& [compressed, plain] : twins) {
        SCOPED_TRACE(compressed);
        LasHeader header, plain_header;
        const std::vector<std::byte> records = all_records(formats / compressed, header);
        EXPECT_TRUE(header.compressed);
        EXPECT_GT(records.size(), 0u);
        EXPECT_TRUE(records == all_records(formats / plain, plain_header));
        std::printf("%-50s %8zu points equal\n", compressed,
                    static_cast<std::size_t>(header.point_count));
    }
}

TEST(Las, EveryReferenceFileHoldsTheCountAndTheBoundsOfItsHeader) {
    GLOWWORM_DATA_OR_SKIP(data);
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(data / "formats")) {
        const std::string extension = entry.path().extension().string();
        if (extension == ".las" || extension == ".laz") paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    EXPECT_GE(paths.size(), 37u);
    for (const std::filesystem::path& path : paths) {
        const std::string name = std::filesystem::relative(path, data / "formats").string();
        SCOPED_TRACE(name);
        // Their points were cut off: one of 719, all of 1065.
        if (name == "pdal/las/garbage_nVariableLength.las" ||
            name == "pdal/las/permutations/1.2-no-points.las") {
            const Outcome outcome = outcome_of_reading(path);
            EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
            std::printf("%-50s %s\n", name.c_str(), outcome.sentence.c_str());
            continue;
        }
        LasHeader header;
        const std::vector<std::byte> records = all_records(path, header);
        if (name == "laspy/simple1_3.las") {  // its writer gives the bounds as they are stored
            EXPECT_EQ(load<std::int32_t>(records.data()), header.bounds_max.x);
        } else if (header.point_count > 0) {
            expect_bounds(records, header);
        }
        std::uint64_t streamed = 0;
        const auto file = open_scan_file(path);
        ScanHeader scan;
        PointBlock block;
        ASSERT_TRUE(file->next_scan(scan));
        while (file->next_block(block))
            streamed += block.size() + block.invalid;
        EXPECT_EQ(streamed, header.point_count);
        std::printf("%-50s %8zu points, %s %s\n", name.c_str(), static_cast<std::size_t>(streamed),
                    file->format().name.c_str(), file->format().version.c_str());
    }
}

TEST(Laz, ACloudOptimizedFileHoldsThePointsItWasMadeFrom) {
    GLOWWORM_DATA_OR_SKIP(data);
    // In another order, so the sums tell.
    std::array<std::uint64_t, 2> intensities{}, reds{};
    const char* names[] = {"pdal/copc/1.2-with-color.copc.laz", "pdal/las/1.2-with-color.las"};
    for (std::size_t i = 0; i < 2; ++i) {
        LasHeader header;
        const std::vector<std::byte> records = all_records(data / "formats" / names[i], header);
        const std::uint32_t colour = las_point_format(header.point_format).colour;
        for (std::size_t at = 0; at < records.size(); at += header.record_bytes) {
            intensities[i] += load<std::uint16_t>(records.data() + at + 12);
            reds[i] += load<std::uint16_t>(records.data() + at + colour);
        }
    }
    EXPECT_EQ(intensities[0], intensities[1]);
    EXPECT_EQ(reds[0], reds[1]);
}

TEST(Laz, AttributesThatNobodyWantsDoNotChangeTheOthers) {
    GLOWWORM_DATA_OR_SKIP(data);
    const InputFile file(data / "formats/pdal/copc/1.2-with-color.copc.laz");
    const LasHeader header = read_las_header(file);
    std::vector<std::byte> all(header.point_count * header.record_bytes), few(all.size());
    open_las_records(file, header, {})->read(all.data(), header.point_count);
    LazLayers positions{};
    positions.classification = positions.intensity = positions.gps_time = positions.colour = false;
    open_las_records(file, header, positions)->read(few.data(), header.point_count);
    EXPECT_FALSE(all == few);
    for (std::size_t at = 0; at < all.size(); at += header.record_bytes) {
        ASSERT_TRUE(std::equal(all.data() + at, all.data() + at + 12, few.data() + at));
    }
}

TEST(Laz, TheOldPointwiseFormIsReadWithoutAChunkTable) {
    GLOWWORM_DATA_OR_SKIP(data);
    // The one chunk of a chunked file is what the pointwise form has, behind 8 bytes of its own.
    const std::filesystem::path formats = data / "formats";
    LasHeader header;
    const std::vector<std::byte> records = all_records(formats / "pdal/laz/simple.laz", header);
    std::string file = file_content(formats / "pdal/laz/simple.laz");
    for (const LasRecord& record : header.records) {
        if (record.user == "laszip encoded") put(file, record.offset, std::uint16_t{1});
    }
    file.erase(header.point_offset, 8);
    const ScratchFolder folder;
    EXPECT_TRUE(records == all_records(write_file(folder / "pointwise.laz", file), header));
}

TEST(Laz, UnknownCompressionIsRefusedWithTheWayToConvertIt) {
    GLOWWORM_DATA_OR_SKIP(data);
    const std::filesystem::path path = data / "formats/pdal/laz/simple.laz";
    LasHeader header;
    all_records(path, header);
    for (const LasRecord& record : header.records) {
        if (record.user != "laszip encoded") continue;
        std::string old_items = file_content(path);
        put(old_items, record.offset + 34 + 4, std::uint16_t{1});
        const Outcome outcome = outcome_of(old_items);
        EXPECT_EQ(outcome.code, ExitCode::kUnreadable);
        EXPECT_THAT(outcome.sentence, ::testing::HasSubstr("laszip -i"));
        std::string coder = file_content(path);
        put(coder, record.offset + 2, std::uint16_t{1});
        EXPECT_EQ(outcome_of(coder).code, ExitCode::kUnreadable);
    }
}

TEST(Laz, AChunkTableOfFourThousandMillionEntriesIsRefused) {
    GLOWWORM_DATA_OR_SKIP(data);
    for (const char* name : {"pdal/laz/simple.laz", "pdal/copc/1.2-with-color.copc.laz"}) {
        const std::filesystem::path path = data / "formats" / name;
        LasHeader header;
        all_records(path, header);
        const std::string whole = file_content(path);
        std::uint64_t table = 0;
        std::memcpy(&table, whole.data() + header.point_offset, 8);
        for (const std::uint32_t count : {0u, 0x80000000u, 0xffffffffu}) {
            std::string file = whole;
            put(file, table + 4, count);
            EXPECT_EQ(outcome_of(file).code, ExitCode::kUnreadable) << name << " " << count;
        }
        for (const std::int64_t position :
             {std::int64_t{0}, std::int64_t{-1}, std::int64_t{1} << 62,
              std::int64_t(header.point_offset)}) {
            std::string file = whole;
            put(file, header.point_offset, position);
            EXPECT_EQ(outcome_of(file).code, ExitCode::kUnreadable) << name << " " << position;
        }
        std::string moved = whole;  // as writers do that cannot go back
        put(moved, header.point_offset, std::int64_t{-1});
        const std::uint64_t at = table;
        moved.append(reinterpret_cast<const char*>(&at), 8);
        EXPECT_EQ(outcome_of(moved).code, ExitCode::kDone) << outcome_of(moved).sentence;
    }
}

TEST(Laz, DamageIsRefusedOrReadButNeverMore) {
    GLOWWORM_DATA_OR_SKIP(data);
    for (const char* name : {"laz-perf/point10-1.0.laz", "pdal/laz/simple.laz",
                             "pdal/copc/1.2-with-color.copc.laz", "laspy/1_4_w_evlr.laz"}) {
        SCOPED_TRACE(name);
        const std::string file = file_content(data / "formats" / name);
        EXPECT_GT(refused_when_cut(file, file.size() / 100 + 1), 50u);
        EXPECT_GT(refused_when_overwritten(file, file.size() / 100 + 1), 1u);
        refused_when_flipped(file, 227, 247);
    }
}

}  // namespace
}  // namespace glowworm::testing
