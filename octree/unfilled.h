#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <vector>

namespace glowworm {

/// An allocator that leaves new elements as the memory was. It takes that from the plain operator
/// new, which a program with a memory limit replaces.
template <typename T>
struct LeaveUnfilled {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
    using value_type = T;

    T* allocate(std::size_t count) { return static_cast<T*>(::operator new(count * sizeof(T))); }
    void deallocate(T* at, std::size_t) { ::operator delete(at); }
    void construct(T*) {}
    template <typename... Arguments>
    void construct(T* at, Arguments&&... arguments) {
        ::new (static_cast<void*>(at)) T(std::forward<Arguments>(arguments)...);
    }
    friend bool operator==(const LeaveUnfilled&, const LeaveUnfilled&) { return true; }
};

/// A vector whose new elements have no values until somebody writes them: a large array is then
/// touched for the first time by the threads that fill it, and only once.
template <typename T>
using Unfilled = std::vector<T, LeaveUnfilled<T>>;

}  // namespace glowworm
