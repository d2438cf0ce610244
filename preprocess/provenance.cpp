#include "preprocess/provenance.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "octree/error.h"
#include "octree/output_path.h"

namespace glowworm {

InputFile describe_input(const std::filesystem::path& path) {
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
    }
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    input.hash = fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    return input;
}

std::string provenance_json(const std::string& command, std::span<const InputFile> inputs) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const InputFile& input : inputs) {
        list.push_back({{"file", input.file}, {"bytes", input.bytes}, {"hash", input.hash}});
    }
    const nlohmann::ordered_json provenance = {
        {"command", command}, {"version", GLOWWORM_VERSION}, {"inputs", list}};
    return provenance.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

}  // namespace glowworm
