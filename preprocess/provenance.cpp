#include "preprocess/provenance.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <xxhash.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/output_path.h"
#include "octree/shared_progress.h"

namespace glowworm {

InputFile describe_input(const std::filesystem::path& path, SharedProgress* progress) {
    require_regular_input(path);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) {
        throw Error(ExitCode::kUnreadable, fmt::format("cannot read '{}'", path.string()));
    }
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                         &XXH3_freeState);
    XXH3_128bits_reset(state.get());
    InputFile input{path.filename().string(), 0, {}};
    std::vector<char> block(std::size_t{1} << 20);
    while (stream.read(block.data(), static_cast<std::streamsize>(block.size())),
           stream.gcount() > 0) {
        const auto bytes = static_cast<std::size_t>(stream.gcount());
        XXH3_128bits_update(state.get(), block.data(), bytes);
        input.bytes += bytes;
        if (progress != nullptr) progress->add(bytes);
    }
    if (stream.bad()) {
        throw Error(ExitCode::kUnreadable,
                    fmt::format("reading '{}' failed; check the disk", path.string()));
    }
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    input.hash = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    return input;
}

std::vector<InputFile> describe_inputs(std::span<const std::filesystem::path> paths,
                                       const Progress& progress) {
    std::uint64_t bytes = 0;
    for (const std::filesystem::path& path : paths) {
        std::error_code unknown;
        const std::uintmax_t size = std::filesystem::file_size(path, unknown);
        if (!unknown) bytes += size;
    }
    SharedProgress shared(progress, bytes, 0.0, 1.0, bytes);
    std::vector<InputFile> inputs(paths.size());
    tbb::parallel_for(std::size_t{0}, paths.size(),
                      [&](std::size_t i) { inputs[i] = describe_input(paths[i], &shared); });
    return inputs;
}

std::string provenance_json(const std::string& command, std::span<const InputFile> inputs,
                            const std::string& settings) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const InputFile& input : inputs) {
        list.push_back({{"file", input.file}, {"bytes", input.bytes}, {"hash", input.hash}});
    }
    nlohmann::ordered_json provenance = {{"command", command}, {"version", GLOWWORM_VERSION}};
    if (!settings.empty()) provenance["settings"] = settings;
    provenance["inputs"] = list;
    return provenance.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace glowworm
