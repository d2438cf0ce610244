// How a flight's frames get into their folder, and what killed flights leave.
#include "viewer/app/frame_folder.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include "octree/error.h"
#include "testing.h"

namespace glowworm {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

void write(const fs::path& path, const std::string& text) {
    std::ofstream(path) << text;
}

std::string text_of(const fs::path& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> names_in(const fs::path& folder) {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder))
        names.push_back(entry.path().filename().string());
    std::sort(names.begin(), names.end());
    return names;
}

/// As if nobody had changed it for a while.
void age(const fs::path& path) {
    fs::last_write_time(path, fs::file_time_type::clock::now() - std::chrono::minutes(2));
}

TEST(FrameFolder, PutsItsFramesInPlaceOfTheOldOnesAndRemovesWhatTheyHadMore) {
    const testing::ScratchFolder scratch;
    const fs::path frames = scratch / "frames";
    fs::create_directory(frames);
    for (const char* name : {"000000.png", "000001.png", "000002.exr", "notes.txt"})
        write(frames / name, "old");
    {
        const FrameFolder folder(frames, ".png");
        write(folder.frame(0), "new");
        EXPECT_EQ(text_of(frames / "000000.png"), "old") << "until all are there";
        folder.finish();
    }
    EXPECT_THAT(names_in(frames), ElementsAre("000000.png", "notes.txt"));
    EXPECT_EQ(text_of(frames / "000000.png"), "new");
}

TEST(FrameFolder, SaysSoWhereAFrameCannotBePutInPlaceAndKeepsTheOldOnes) {
    const testing::ScratchFolder scratch;
    const fs::path frames = scratch / "frames";
    fs::create_directories(frames / "000000.png" / "a folder that is full");
    write(frames / "000007.png", "old");
    {
        const FrameFolder folder(frames, ".png");
        write(folder.frame(0), "new");
        EXPECT_THROW(folder.finish(), Error);
    }
    EXPECT_THAT(names_in(frames), ElementsAre("000000.png", "000007.png"));
}

TEST(FrameFolder, RemovesWhatWasLeftBesideItAndInItWhereItIsThereByNow) {
    const testing::ScratchFolder scratch;
    const fs::path frames = scratch / "frames";
    fs::create_directory(frames);
    for (const fs::path& killed :
         {scratch / ".frames.1.0.partial", frames / ".frames.2.0.partial"}) {
        fs::create_directory(killed);
        write(killed / "000000.png", "left");
        age(killed);
    }
    {
        const FrameFolder folder(frames, ".png");
        write(folder.frame(0), "new");
        folder.finish();
    }
    EXPECT_THAT(names_in(scratch.path()), ElementsAre("frames"));
    EXPECT_THAT(names_in(frames), ElementsAre("000000.png"));
}

TEST(FrameFolder, RemovesWhatKilledFlightsLeftButNothingThatIsInUse) {
    const testing::ScratchFolder scratch;
    const fs::path frames = scratch / "frames", killed = scratch / ".frames.1.0.partial",
                   other = scratch / ".others.1.0.partial";
    for (const fs::path& path : {killed, other}) {
        fs::create_directory(path);
        write(path / "000000.png", "left");
        age(path);
    }
    const FrameFolder running(frames, ".png");
    write(running.frame(0), "of the one that runs");
    age(running.frame(0).parent_path());
    {
        const FrameFolder folder(frames, ".png");
        EXPECT_FALSE(fs::exists(killed));
        EXPECT_TRUE(fs::exists(other)) << "another output's";
        EXPECT_TRUE(fs::exists(running.frame(0)));
        EXPECT_NE(folder.frame(0), running.frame(0));
    }
    running.finish();
    EXPECT_THAT(names_in(scratch.path()), ElementsAre(".others.1.0.partial", "frames"));
    EXPECT_THAT(names_in(frames), ElementsAre("000000.png"));
}

}  // namespace
}  // namespace glowworm
