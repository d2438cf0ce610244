#include <gmock/gmock.h>

#include <cstddef>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include "octree/node_layout.h"
#include "octree/trace.h"
#include "shaders/gpu_layout.h"
#include "testing.h"

namespace glowworm {
namespace {

struct Place {
    std::size_t offset = 0;
    std::size_t stride = 0;  ///< of the array of records, 0 where it is none
};

std::size_t number_after(const std::string& text, const std::string& key) {
    const auto at = text.find(key);
    return at == std::string::npos ? 0 : std::stoul(text.substr(at + key.size()));
}

/// Where glslangValidator puts the members of buffers and uniform blocks, by name.
std::map<std::string, Place> reflect(const std::string& shader) {
    const testing::ScratchFolder folder;
    std::ofstream(folder / "layout.comp") << shader;
    const std::string command = std::string(GLOWWORM_GLSLANG_VALIDATOR) + " -l -q -I" +
                                GLOWWORM_SHADER_FOLDER + " " + (folder / "layout.comp").string();
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(::popen(command.c_str(), "r"), ::pclose);
    std::map<std::string, Place> places;
    char line[512];
    while (pipe && std::fgets(line, sizeof line, pipe.get()) != nullptr) {
        // "lobes.area: offset 12, type 1406, ..., topLevelArrayStride 64"
        const std::string text = line;
        const auto colon = text.find(": offset ");
        if (colon == std::string::npos || text.find("offset -1") != std::string::npos) continue;
        places[text.substr(0, colon)] = {number_after(text, "offset "),
                                         number_after(text, "topLevelArrayStride ")};
    }
    return places;
}

constexpr const char* kReadsAll = R"(#version 450
#extension GL_GOOGLE_include_directive : require
#include "direct_light.glsl"
layout(local_size_x = 1) in;
layout(std430, binding = BINDING_DIRECT) buffer Out { vec4 result[]; };
void main() {
    Node node = nodes[1];
    Lobe lobe = lobes[1];
    Light light = lights[1];
    LightGrid g = grid;
    result[0] = light.position + float(lobe.light + node.mask + node.first + g.depth);
}
)";

#define EXPECT_PLACE(name, record, field) \
    EXPECT_EQ(places.at(name "." #field).offset, offsetof(record, field)) << #field

TEST(LightLayout, ShadersSeeTheRecordsWhereCppPutsThem) {
    const auto places = reflect(kReadsAll);
    ASSERT_TRUE(places.contains("nodes.mask")) << "glslangValidator reflected nothing";
    EXPECT_EQ(places.at("nodes.mask").stride, sizeof(Node));
    EXPECT_PLACE("nodes", Node, mask);
    EXPECT_PLACE("nodes", Node, first);
    EXPECT_EQ(places.at("lobes.area").stride, sizeof(Lobe));
    EXPECT_PLACE("lobes", Lobe, position);
    EXPECT_PLACE("lobes", Lobe, area);
    EXPECT_PLACE("lobes", Lobe, ndf);
    EXPECT_PLACE("lobes", Lobe, plane_sigma);
    EXPECT_PLACE("lobes", Lobe, albedo);
    EXPECT_PLACE("lobes", Lobe, light);
    EXPECT_PLACE("lobes", Lobe, patch_min);
    EXPECT_PLACE("lobes", Lobe, patch_max);
    EXPECT_PLACE("lobes", Lobe, emission);
    EXPECT_PLACE("lobes", Lobe, spacing);
    EXPECT_EQ(places.at("lights.kind").stride, sizeof(gpu::Light));
    EXPECT_PLACE("lights", gpu::Light, position);
    EXPECT_PLACE("lights", gpu::Light, intensity);
    EXPECT_PLACE("lights", gpu::Light, axis);
    EXPECT_PLACE("lights", gpu::Light, edge_u);
    EXPECT_PLACE("lights", gpu::Light, edge_v);
    EXPECT_PLACE("lights", gpu::Light, kind);
    EXPECT_PLACE("lights", gpu::Light, tag);
    EXPECT_PLACE("grid", gpu::LightGrid, cube_min_x);
    EXPECT_PLACE("grid", gpu::LightGrid, voxel_size);
    EXPECT_PLACE("grid", gpu::LightGrid, depth);
    EXPECT_PLACE("grid", gpu::LightGrid, lobe_count);
    EXPECT_PLACE("grid", gpu::LightGrid, light_count);
    EXPECT_PLACE("grid", gpu::LightGrid, flags);
    EXPECT_PLACE("grid", gpu::LightGrid, patch_margin);
    EXPECT_PLACE("grid", gpu::LightGrid, reach);
    EXPECT_PLACE("grid", gpu::LightGrid, links_per_lobe);
}

TEST(LightLayout, MarksOfRaysThatMeetNothingAreTheSame) {
    EXPECT_EQ(NO_HIT, kNoHit);
    EXPECT_EQ(BURIED, kBuried);
}

}  // namespace
}  // namespace glowworm
