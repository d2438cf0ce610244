#include "preprocess/pipeline/hash.h"

#include <fmt/format.h>
#include <xxhash.h>

namespace glowworm {

void Hash::Free::operator()(XXH3_state_s* state) const {
    XXH3_freeState(state);
}

Hash::Hash() : state_(XXH3_createState()) {
    XXH3_128bits_reset(state_.get());
}

Hash& Hash::bytes(const void* data, std::size_t size) {
    XXH3_128bits_update(state_.get(), data, size);
    return *this;
}

std::string Hash::hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace glowworm
