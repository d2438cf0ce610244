#include <gmock/gmock.h>

#include <array>
#include <cstdlib>
#include <fstream>

#include "octree/error.h"
#include "testing.h"
#include "viewer/gpu/context.h"
#include "viewer/gpu/objects.h"
#include "viewer/gpu/program.h"
#include "viewer/gpu/shader_source.h"
#include "viewer/gpu/timer.h"

namespace glowworm {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void write_text(const std::filesystem::path& path, const std::string& text) {
    std::ofstream(path) << text;
}

/// A folder of shaders of this test's own, in place of the program's.
class OwnShaders : public ::testing::Test {
  protected:
    void SetUp() override { ::setenv("GLOWWORM_SHADERS", folder_.path().c_str(), 1); }
    void TearDown() override { ::unsetenv("GLOWWORM_SHADERS"); }
    testing::ScratchFolder folder_;
    Context context_ = Context::headless();
};

constexpr const char* kDoubling = R"(#version 450
#include "scale.glsl"
layout(local_size_x = 64) in;
layout(std430, binding = 0) buffer Values { float values[]; };
void main() {
    if (gl_GlobalInvocationID.x < values.length()) {
        values[gl_GlobalInvocationID.x] *= scale();
    }
}
)";

TEST(Gpu, AHeadlessContextOffersOpenGL45) {
    const Context context = Context::headless();
    EXPECT_FALSE(context.device().renderer.empty());
    EXPECT_GE(context.device().max_storage_bytes, 128 << 20);
    EXPECT_THAT(context.errors(), IsEmpty());
}

TEST(Gpu, AWrongCallIsReported) {
    const Context context = Context::headless();
    glBindTextureUnit(0, 12345);
    EXPECT_EQ(context.errors().size(), 1u);
}

TEST(Gpu, TwoContextsCanFollowEachOther) {
    for (int i = 0; i < 2; ++i) {
        const Context context = Context::headless();
        const Buffer buffer = Buffer::of<float>("numbers", std::array{1.0f, 2.0f});
        EXPECT_THAT(buffer.read<float>(2), ElementsAre(1.0f, 2.0f));
    }
}

TEST(Gpu, ABufferStartsAsZerosAndRefusesWritesPastItsEnd) {
    const Context context = Context::headless();
    Buffer buffer("zeros", 12);
    EXPECT_THAT(buffer.read<float>(3), ElementsAre(0.0f, 0.0f, 0.0f));
    EXPECT_THROW(buffer.write(std::vector{1.0f, 2.0f}, 2), Error);
    EXPECT_THROW(buffer.read<float>(4), Error);
    Buffer empty("empty", 0);
    empty.bind_storage(0);
    EXPECT_THAT(context.errors(), IsEmpty());
}

TEST_F(OwnShaders, AComputePassRunsOverEveryValueOnce) {
    write_text(folder_ / "scale.glsl", "float scale() { return 2.0; }\n");
    write_text(folder_ / "double.comp", kDoubling);
    const Program program({"double.comp"});
    const Buffer values = Buffer::of<float>("values", std::vector<float>(1000, 1.5f));
    values.bind_storage(0);
    PassTimer timer(context_.device());
    timer.measure("double", [&] { program.dispatch(1000, 64); });
    EXPECT_THAT(values.read<float>(1000), ::testing::Each(3.0f));
    EXPECT_GT(timer.samples().at("double").front().cpu_ms, 0.0);
    EXPECT_THAT(context_.errors(), IsEmpty());
}

TEST_F(OwnShaders, AnErrorInsideAnIncludeNamesItsFileAndLine) {
    write_text(folder_ / "scale.glsl", "// first line\nfloat scale() { return nonsense; }\n");
    write_text(folder_ / "double.comp", kDoubling);
    try {
        const Program program({"double.comp"});
        FAIL() << "it compiled";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("scale.glsl:2"));
    }
}

TEST_F(OwnShaders, AMissingIncludeNamesWhoWantsIt) {
    write_text(folder_ / "double.comp", kDoubling);
    try {
        read_shader(folder_.path(), "double.comp");
        FAIL() << "it was found";
    } catch (const Error& error) {
        EXPECT_THAT(error.what(), HasSubstr("double.comp:2"));
    }
}

TEST_F(OwnShaders, AFileIncludedTwiceIsPutInOnceAndAnEndlessCycleEnds) {
    write_text(folder_ / "a.glsl", "#include \"b.glsl\"\nint a;\n");
    write_text(folder_ / "b.glsl", "#include \"a.glsl\"\nint b;\n");
    write_text(folder_ / "cycle.comp", "#version 450\n#include \"a.glsl\"\n#include \"b.glsl\"\n");
    const ShaderSource source =
        read_shader(folder_.path(), "cycle.comp", std::array{std::string("N 3")});
    EXPECT_EQ(source.text, "#version 450\n#define N 3\nint b;\nint a;\n");
    ASSERT_EQ(source.lines.size(), 4u);
    EXPECT_EQ(source.lines[3].line, 2u);
}

TEST_F(OwnShaders, AChangedFileIsReloadedAndAnErrorKeepsTheGoodProgram) {
    write_text(folder_ / "scale.glsl", "float scale() { return 2.0; }\n");
    write_text(folder_ / "double.comp", kDoubling);
    Program program({"double.comp"});
    EXPECT_FALSE(program.reload_if_changed());
    const auto later = std::filesystem::file_time_type::clock::now() + std::chrono::seconds(5);

    write_text(folder_ / "scale.glsl", "float scale() { return; }\n");
    std::filesystem::last_write_time(folder_ / "scale.glsl", later);
    const GLuint kept = program.name();
    EXPECT_TRUE(program.reload_if_changed().has_value());
    EXPECT_EQ(program.name(), kept);

    write_text(folder_ / "scale.glsl", "float scale() { return 4.0; }\n");
    std::filesystem::last_write_time(folder_ / "scale.glsl", later + std::chrono::seconds(5));
    EXPECT_FALSE(program.reload_if_changed());
    const Buffer values = Buffer::of<float>("values", std::array{1.0f});
    values.bind_storage(0);
    program.dispatch(1, 64);
    EXPECT_THAT(values.read<float>(1), ElementsAre(4.0f));
}

}  // namespace
}  // namespace glowworm
