#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "octree/atomic_file.h"
#include "preprocess/pipeline/hash.h"

namespace glowworm {

/// Writes the values it is called with one after the other and their hash after them, as this
/// machine has them in memory. Throws as AtomicFile does.
class ArchiveWriter {
  public:
    ArchiveWriter(const std::filesystem::path& path, const std::string& key);

    template <typename T>
    void operator()(const T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            put(&value, sizeof(T));
        } else {
            archive(*this, value);
        }
    }
    void operator()(const std::string& text);
    template <typename T>
    void operator()(const std::optional<T>& value) {
        (*this)(value.has_value());
        if (value) (*this)(*value);
    }
    template <typename T>
    void operator()(const std::vector<T>& values) {
        (*this)(static_cast<std::uint64_t>(values.size()));
        if constexpr (std::is_trivially_copyable_v<T>) {
            put(values.data(), values.size() * sizeof(T));
        } else {
            for (const T& value : values)
                (*this)(value);
        }
    }
    template <typename... Values>
    requires(sizeof...(Values) > 1) void operator()(const Values&... values) {
        ((*this)(values), ...);
    }

    /// The file is there, whole, only after this.
    void commit();

  private:
    void put(const void* data, std::size_t bytes);
    void flush();

    AtomicFile file_;
    std::string waiting_;  // small values, written together
    Hash hash_;
};

/// Reads what ArchiveWriter wrote; an empty key is every key. A file that is damaged, or was
/// written for another key, is as good as none: nothing throws, `good` is false, and nothing is
/// read from it, since a bool or an enum of any bytes would be none. The hash is looked at first.
class ArchiveReader {
  public:
    ArchiveReader(const std::filesystem::path& path, const std::string& key);

    template <typename T>
    void operator()(T& value) {
        if constexpr (std::is_trivially_copyable_v<T>) {
            take(&value, sizeof(T));
        } else {
            archive(*this, value);
        }
    }
    void operator()(std::string& text);
    template <typename T>
    void operator()(std::optional<T>& value) {
        bool there = false;
        (*this)(there);
        if (good_ && there) (*this)(value.emplace());
    }
    template <typename T>
    void operator()(std::vector<T>& values) {
        std::uint64_t size = 0;
        (*this)(size);
        constexpr std::size_t least = std::is_trivially_copyable_v<T> ? sizeof(T) : 1;
        if (size > left_ / least) good_ = false;
        if (!good_) return;
        values.resize(size);
        if constexpr (std::is_trivially_copyable_v<T>) {
            take(values.data(), values.size() * sizeof(T));
        } else {
            for (T& value : values)
                (*this)(value);
        }
    }
    template <typename... Values>
    requires(sizeof...(Values) > 1) void operator()(Values&... values) { ((*this)(values), ...); }

    /// Whether all was read that was written. To be asked last.
    bool good() const { return good_ && left_ == 0; }

  private:
    void take(void* data, std::size_t bytes);
    bool is_whole();

    std::ifstream stream_;
    std::uint64_t left_ = 0;  // bytes before the hash
    bool good_ = false;
};

}  // namespace glowworm
