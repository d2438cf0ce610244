#include "preprocess/pipeline/hash.h"

#include <fmt/format.h>

namespace glowworm {

std::string Hash::hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace glowworm
