#include "preprocess/command/convert_flags.h"

#include "octree/links.h"

namespace glowworm {

void ConvertFlags::add_to(CLI::App& command) {
    build.links = LinkSettings{}.rays;  // what the viewer uses
    command.add_option("scans", inputs, "scan files or folders of them")->required();
    registration.add_to(command);
    build.add_to(command);
    add_read_flags(command, settings.read);
    add_surface_flags(command, settings.surface);
    command.add_flag("--allow-missing-scans", settings.allow_missing_scans,
                     "go on without scans that could not be placed");
}

void ConvertFlags::apply() {
    registration.apply(settings.registration);
    settings.area_lights = build.area_lights();
    settings.build.depth = build.depth;
    settings.build.voxel_size = build.voxel_size;
    settings.links = build.links;
}

void ConvertFlags::apply_provenance(std::span<const ScanInput> scans) {
    std::vector<InputFile> contents;
    for (const ScanInput& scan : scans)
        contents.push_back(scan.content);
    settings.build = build.settings("convert", contents, settings_hash(settings));
}

Stage ConvertFlags::last_stage() const {
    if (until == "ingest") return Stage::kIngest;
    if (until == "register") return Stage::kRegister;
    if (until == "merge") return Stage::kMerge;
    if (until == "surface") return Stage::kSurface;
    return Stage::kBuild;
}

std::vector<ScanInput> describe_scans(std::span<const std::filesystem::path> files,
                                      const Progress& progress) {
    std::vector<InputFile> contents = describe_inputs(files, progress);
    std::vector<ScanInput> inputs;
    for (std::size_t i = 0; i < files.size(); ++i)
        inputs.push_back({files[i], std::move(contents[i])});
    return inputs;
}

}  // namespace glowworm
