#pragma once

#include <bit>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace glowworm {

static_assert(std::endian::native == std::endian::little,
              "files are copied into numbers as they are");

/// The number of type T whose little-endian bytes begin at `from`.
template <typename T>
T load(const std::byte* from) {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    std::memcpy(&value, from, sizeof(T));
    return value;
}

template <typename T>
void store(std::byte* to, const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(to, &value, sizeof(T));
}

}  // namespace glowworm
