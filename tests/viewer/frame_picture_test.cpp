#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <cstring>
#include <fstream>

#include "octree/error.h"
#include "testing.h"
#include "viewer/frame/exr.h"
#include "viewer/frame/png.h"

namespace glowworm {
namespace {

FrameLayers numbered_layers(int width, int height) {
    FrameLayers layers(width, height);
    float next = 0.0f;
    for (auto* layer : {&layers.direct, &layers.indirect, &layers.specular, &layers.emission,
                        &layers.albedo, &layers.normal}) {
        for (Vec3f& v : *layer)
            v = {next += 0.25f, next += 0.25f, next += 0.25f};
    }
    for (float& z : layers.depth)
        z = next += 0.25f;
    for (float& n : layers.ndf_length)
        n = next += 0.25f;
    return layers;
}

View small_view(int width, int height) {
    Camera camera;
    camera.position = {1, 2, 3};
    camera.look_at = {4, 6, 2};
    camera.width = width;
    camera.height = height;
    return view_of(camera);
}

void write(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

TEST(Exr, KeepsEveryLayerAndItsBeautyIsTheirSum) {
    const testing::ScratchFolder folder;
    const FrameLayers layers = numbered_layers(7, 5);
    write(folder / "a.exr", encode_exr(layers, small_view(7, 5)));
    const ExrChannels exr = read_exr(folder / "a.exr");
    ASSERT_EQ(exr.width, 7);
    ASSERT_EQ(exr.height, 5);
    EXPECT_EQ(exr.channels.size(), 3u * 6 + 3 + 2);
    for (std::size_t i = 0; i < 35; ++i) {
        EXPECT_EQ(exr.channels.at("G")[i],
                  exr.channels.at("direct.G")[i] + exr.channels.at("indirect.G")[i] +
                      exr.channels.at("specular.G")[i] + exr.channels.at("emission.G")[i]);
        EXPECT_EQ(exr.channels.at("albedo.B")[i], layers.albedo[i].z);
        EXPECT_EQ(exr.channels.at("N.Y")[i], layers.normal[i].y);
        EXPECT_EQ(exr.channels.at("Z")[i], layers.depth[i]);
        EXPECT_EQ(exr.channels.at("ndf.len")[i], layers.ndf_length[i]);
    }
}

TEST(Exr, GivesTheSameBytesTwice) {
    const FrameLayers layers = numbered_layers(16, 9);
    EXPECT_EQ(encode_exr(layers, small_view(16, 9)), encode_exr(layers, small_view(16, 9)));
}

TEST(Exr, RefusesWhatIsNoPicture) {
    const testing::ScratchFolder folder;
    const std::string bytes = encode_exr(numbered_layers(16, 9), small_view(16, 9));
    write(folder / "cut.exr", bytes.substr(0, bytes.size() / 2));
    write(folder / "text.exr", "not a picture");
    for (const char* name : {"cut.exr", "text.exr", "absent.exr"}) {
        try {
            read_exr(folder / name);
            ADD_FAILURE() << name << " was read";
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ExitCode::kUnreadable);
            EXPECT_THAT(error.what(), ::testing::HasSubstr(name));
        }
    }
}

TEST(Png, KeepsEveryPixel) {
    Picture picture{5, 3, {}};
    for (int i = 0; i < 45; ++i)
        picture.rgb.push_back(static_cast<unsigned char>(i * 5));
    const std::string bytes = encode_png(picture);
    EXPECT_EQ(bytes, encode_png(picture)) << "the same bytes twice";

    png_image image = {};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
    EXPECT_EQ(image.width, 5u);
    EXPECT_EQ(image.height, 3u);
    image.format = PNG_FORMAT_RGB;
    std::vector<unsigned char> back(45);
    ASSERT_TRUE(png_image_finish_read(&image, nullptr, back.data(), 0, nullptr));
    EXPECT_EQ(back, picture.rgb);
}

}  // namespace
}  // namespace glowworm
