#pragma once

#include <xxhash.h>

#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

namespace glowworm {

/// XXH3-128 over a sequence of texts, numbers and bytes. Texts are preceded by their length, so
/// that ("ab", "c") and ("a", "bc") differ.
class Hash {
  public:
    Hash() { XXH3_128bits_reset(state_.get()); }

    Hash& bytes(const void* data, std::size_t size) {
        XXH3_128bits_update(state_.get(), data, size);
        return *this;
    }
    Hash& add(std::string_view text) {
        const std::uint64_t size = text.size();
        return bytes(&size, sizeof(size)).bytes(text.data(), text.size());
    }
    template <typename Number>
    requires std::is_arithmetic_v<Number> Hash& add(Number number) {
        return bytes(&number, sizeof(number));
    }

    /// 32 hexadecimal digits.
    std::string hex() const;

  private:
    struct Free {
        void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
    };
    std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

}  // namespace glowworm
