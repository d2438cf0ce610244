#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>

struct XXH3_state_s;

namespace glowworm {

/// XXH3-128 over a sequence of texts, numbers and bytes. Texts are preceded by their length, so
/// that ("ab", "c") and ("a", "bc") differ.
class Hash {
  public:
    Hash();

    Hash& bytes(const void* data, std::size_t size);
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
        void operator()(XXH3_state_s* state) const;
    };
    std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace glowworm
