// Bad input: one sentence, the exit code of the contract, nothing under the final name.

#include <sys/stat.h>

#include <fstream>

#include "program.h"
#include "testing.h"

namespace glowworm::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path, std::ios::binary) << text;
}

/// One sentence: one line that names the program first.
void expect_refused(const Ended& ended, int code, const std::string& word) {
    EXPECT_EQ(ended.code, code) << ended.err;
    EXPECT_THAT(ended.err, HasSubstr(word));
    EXPECT_THAT(ended.err, HasSubstr("glowworm"));
    EXPECT_EQ(std::count(ended.err.begin(), ended.err.end(), '\n'), 1) << ended.err;
    EXPECT_THAT(ended.out, IsEmpty());
}

std::string demo_scan() {
    return GLOWWORM_ROOT "/demo/scans/1_chamber_south.ply";
}

TEST(BadInput, AFileThatIsNotThere) {
    const ScratchFolder folder;
    expect_refused(glowworm({"convert", folder / "no.ply", "-o", folder / "cave.svo"}), 3,
                   "no.ply");
    EXPECT_THAT(names_in(folder.path()), IsEmpty());
}

TEST(BadInput, AnEmptyFile) {
    const ScratchFolder folder, results;
    write_text(folder / "empty.ply", "");
    expect_refused(glowworm({"convert", folder / "empty.ply", "-o", results / "cave.svo"}), 3,
                   "empty.ply");
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, ATruncatedScan) {
    const ScratchFolder folder, results;
    std::filesystem::copy(demo_scan(), folder / "cut.ply");
    std::filesystem::resize_file(folder / "cut.ply", 700'001);
    expect_refused(glowworm({"convert", folder / "cut.ply", "-o", results / "cave.svo"}), 3,
                   "cut.ply");
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, ATrajectoryThatIsNotThereOrHoldsNoPoses) {
    const ScratchFolder folder, results;
    write_text(folder / "short.txt", "1 2\n");
    write_text(folder / "words.txt", "nothing but words\n");
    for (const std::string command : {"surface", "convert"}) {
        const auto run = [&](const std::string& file) {
            return glowworm({command, demo_scan(), "--trajectory", folder / file, "-o",
                             results / (command == "surface" ? "out.ply" : "out.svo")});
        };
        expect_refused(run("none.txt"), 3, "none.txt");
        expect_refused(run("short.txt"), 3, "line 1");
        expect_refused(run("words.txt"), 4, "no poses");
    }
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, PointsThatLieOnNoSurface) {
    const ScratchFolder folder, results;
    std::string line, same;
    for (int i = 0; i < 200; ++i) {
        line += std::to_string(i * 0.01) + " 2 3\n";
        same += "1 2 3\n";
    }
    write_text(folder / "line.xyz", line);
    write_text(folder / "same.xyz", same);
    write_text(folder / "one.xyz", "1 2 3\n");
    write_text(folder / "two.xyz", "1 2 3\n4 5 6\n");
    for (const char* file : {"line.xyz", "same.xyz", "one.xyz", "two.xyz"}) {
        expect_refused(glowworm({"surface", folder / file, "-o", results / "out.ply"}), 4, "point");
    }
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, AnUnknownKind) {
    const ScratchFolder folder, results;
    write_text(folder / "what.bin", std::string("\x01\x02\x03\x04 what is this\x00\xff", 19));
    expect_refused(glowworm({"convert", folder / "what.bin", "-o", results / "cave.svo"}), 3,
                   "what.bin");
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, AFolderWithoutScans) {
    const ScratchFolder folder, results;
    write_text(folder / "notes.md", "# nothing here\n");
    expect_refused(glowworm({"convert", folder.path(), "-o", results / "cave.svo"}), 3,
                   folder.path().filename().string());
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, AScanWithoutPoints) {
    const ScratchFolder folder, results;
    write_text(folder / "none.ply",
               "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n");
    expect_refused(glowworm({"convert", folder / "none.ply", "-o", results / "cave.svo"}), 4,
                   "none.ply");
    EXPECT_THAT(names_in(results.path()), IsEmpty());
}

TEST(BadInput, AnOutputFolderThatIsNotThere) {
    const ScratchFolder folder;
    expect_refused(glowworm({"convert", demo_scan(), "-o", folder / "missing/cave.svo"}), 3,
                   "missing");
}

TEST(BadInput, AnOutputThatIsThereIsKept) {
    const ScratchFolder folder;
    write_text(folder / "cave.svo", "mine");
    expect_refused(glowworm({"convert", demo_scan(), "-o", folder / "cave.svo"}), 7, "--force");
    EXPECT_EQ(std::filesystem::file_size(folder / "cave.svo"), 4u);
}

TEST(BadInput, InputAndOutputAtOnce) {
    const ScratchFolder folder;
    std::filesystem::copy(demo_scan(), folder / "scan.ply");
    expect_refused(glowworm({"convert", folder / "scan.ply", "-o", folder / "scan.ply", "--force"}),
                   2, "scan.ply");
    EXPECT_EQ(std::filesystem::file_size(folder / "scan.ply"),
              std::filesystem::file_size(demo_scan()));
}

TEST(BadInput, AnOutputThatIsADeviceIsLeftAlone) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.svo").c_str(), 0600), 0);
    expect_refused(glowworm({"convert", demo_scan(), "-o", folder / "pipe.svo", "--force"}), 2,
                   "no regular file");
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe.svo"));
}

TEST(BadInput, APipeAsInputDoesNotHang) {
    const ScratchFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe.ply").c_str(), 0600), 0);
    expect_refused(glowworm({"convert", folder / "pipe.ply", "-o", folder / "cave.svo"}), 3,
                   "pipe.ply");
    expect_refused(glowworm({"convert", demo_scan(), "--lights", folder / "pipe.ply", "-o",
                             folder / "cave.svo"}),
                   3, "pipe.ply");
}

TEST(BadInput, SomeonesFileBesideTheOutputIsKept) {
    const ScratchFolder folder;
    write_text(folder / "cave.svo.poses.json", "mine");
    expect_refused(glowworm({"convert", demo_scan(), "-o", folder / "cave.svo"}), 7, "--force");
    EXPECT_EQ(std::filesystem::file_size(folder / "cave.svo.poses.json"), 4u);
}

TEST(BadInput, WrongUsage) {
    EXPECT_EQ(glowworm({}).code, 2);
    EXPECT_EQ(glowworm({"dig"}).code, 2);
    EXPECT_EQ(glowworm({"convert", "--depth", "lots"}).code, 2);
    EXPECT_EQ(glowworm({"convert", demo_scan()}).code, 2);
    EXPECT_EQ(glowworm({"--help"}).code, 0);
    EXPECT_EQ(glowworm({"--version"}).code, 0);
}

TEST(BadInput, BuildWithoutNormalsSaysToRunSurface) {
    const ScratchFolder folder;
    expect_refused(glowworm({"build", demo_scan(), "-o", folder / "cave.svo"}), 4, "surface");
    EXPECT_THAT(names_in(folder.path()), IsEmpty());
}

TEST(BadInput, AnOctreeFileThatIsNone) {
    const ScratchFolder folder;
    write_text(folder / "cave.svo", "GLOWSVO? no");
    expect_refused(glowworm({"info", folder / "cave.svo"}), 3, "cave.svo");
    EXPECT_NE(glowworm({"check", folder / "cave.svo"}).code, 0);
}

}  // namespace
}  // namespace glowworm::testing
