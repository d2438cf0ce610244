#pragma once

#include <tbb/parallel_for.h>

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <type_traits>
#include <vector>

#include "octree/progress.h"

namespace glowworm {

/// [files] what `of_file(i)` makes of each, several at a time; `progress` counts files. What the
/// first of those that failed threw is thrown when all that had begun have ended.
template <typename OfFile>
auto for_all_files(std::size_t files, const Progress& progress, const OfFile& of_file) {
    std::vector<std::invoke_result_t<OfFile, std::size_t>> all(files);
    std::vector<std::exception_ptr> failures(files);
    std::atomic<bool> failed = false;
    std::mutex mutex;
    std::uint64_t done = 0;
    tbb::parallel_for(std::size_t{0}, files, [&](std::size_t i) {
        if (failed) return;
        try {
            all[i] = of_file(i);
            const std::lock_guard lock(mutex);
            ++done;
            if (progress) progress(done, files);
        } catch (...) {
            failures[i] = std::current_exception();
            failed = true;
        }
    });
    for (const std::exception_ptr& failure : failures) {
        if (failure) std::rethrow_exception(failure);
    }
    return all;
}

}  // namespace glowworm
