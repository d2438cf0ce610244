#include "octree/extract.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "octree/error.h"
#include "octree/octree_writer.h"
#include "octree/pack.h"
#include "preprocess/command/command.h"
#include "preprocess/command/plan.h"
#include "preprocess/command/stage_flags.h"
#include "preprocess/points.h"
#include "preprocess/write/cloud_writer.h"

namespace glowworm {
namespace {

struct ExtractFlags {
    std::filesystem::path input;
    std::optional<std::uint32_t> level;
    std::vector<double> box;
};

/// Voxel centres with albedo, NDF and opacity (as intensity), for any point tool.
PointCloud to_cloud(const std::vector<Voxel>& voxels, const Vec3d& origin) {
    PointCloud cloud;
    cloud.origin = origin;
    for (const Voxel& voxel : voxels) {
        cloud.points.positions.push_back(voxel.centre);
        cloud.points.normals.push_back(normalized(voxel.ndf));
        cloud.points.ndf_lengths.push_back(std::clamp(length(voxel.ndf), 1e-3f, 1.0f));
        cloud.points.colours.push_back(
            {pack_srgb8(voxel.albedo.x), pack_srgb8(voxel.albedo.y), pack_srgb8(voxel.albedo.z)});
        cloud.points.intensities.push_back(voxel.opacity);
    }
    return cloud;
}

nlohmann::ordered_json run_extract(Run& run, const ExtractFlags& flags) {
    const std::filesystem::path& output = run.flags.output;
    require_distinct(output, {flags.input});
    if (flags.level.has_value() == !flags.box.empty()) {
        throw Error(ExitCode::kUsage,
                    "extract takes one of --level N (voxels as points) and --box (a part cut out)");
    }
    for (std::size_t axis = 0; axis + 3 < flags.box.size(); ++axis) {
        if (flags.box[axis] <= flags.box[axis + 3]) continue;
        throw Error(ExitCode::kUsage,
                    "the box's first corner must be its lower one: x y z, then x y z");
    }
    if (flags.level) check_cloud_extension(output);
    page_memory(run);
    const Progress progress = run.console.phase("extract", "steps");
    progress(0, 1);
    const OctreeFile file = OctreeFile::open(flags.input);
    if (flags.level) {
        require_sound(file, flags.input,
                      {SectionKind::kLevels, SectionKind::kNodes, SectionKind::kAttributes});
        throw_if_cancelled();
        const std::vector<Voxel> voxels = extract_level(file.view(), *flags.level);
        file.require_intact();
        throw_if_cancelled();
        write_cloud(to_cloud(voxels, file.view().grid.origin), output);
        return {{"output", output.string()}, {"level", *flags.level}, {"voxels", voxels.size()}};
    }
    require_sound(file, flags.input);
    throw_if_cancelled();
    const Vec3d origin = file.view().grid.origin;
    const Vec3d low{flags.box[0], flags.box[1], flags.box[2]},
        high{flags.box[3], flags.box[4], flags.box[5]};
    const Octree cut =
        cut_box(file.view(), {vec3_cast<float>(low - origin), vec3_cast<float>(high - origin)});
    file.require_intact();
    if (file.view().links_per_lobe > 0) {
        spdlog::warn(
            "the part is written without links: those of the whole lead out of it; the viewer "
            "traces its own");
    }
    write_octree_file(cut.view(), output, {.progress = run.console.phase("write", "bytes")});
    return {{"output", output.string()},
            {"leaves", cut.levels.back().node_count},
            {"surfels", cut.surfels.size()}};
}

}  // namespace

void add_extract_command(Program& program) {
    auto flags = std::make_shared<ExtractFlags>();
    CLI::App* command =
        program.add("extract", "a level of an octree as points, or the part inside a box", true,
                    [flags](Run& run) { return run_extract(run, *flags); });
    command->add_option("file", flags->input, "an .svo file")->required();
    command->add_option("--level", flags->level, "write the voxels of this level as a cloud")
        ->check(CLI::Range(0u, kMaxDepth));
    command
        ->add_option("--box", flags->box,
                     "x y z of both corners, m, world: write this part as an .svo, without links")
        ->expected(6)
        ->check(finite(-1e12, 1e12));
}

}  // namespace glowworm
