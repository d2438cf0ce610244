#include "preprocess/command/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "octree/error.h"
#include "octree/resident_memory.h"
#include "preprocess/command/command.h"
#include "preprocess/command/loader_pages.h"

namespace glowworm {
namespace {

constexpr std::uint64_t kProgramPages = 20'000'000;  // libraries' code and tables, measured
constexpr std::uint64_t kLeastData = 4'000'000;
constexpr std::uint64_t kStack = 8'388'608;  // counted whole by the system, hardly ever touched

/// What a unit stands for; 0 where it is none.
double unit_bytes(std::string unit) {
    for (char& c : unit)
        c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (unit.empty() || unit == "b") return 1.0;
    const std::size_t power = std::string("kmgt").find(unit[0]);
    if (power == std::string::npos) return 0.0;
    const std::string rest = unit.substr(1);
    if (rest.empty() || rest == "b") return std::pow(1000.0, double(power) + 1.0);
    return rest == "ib" || rest == "i" ? std::pow(1024.0, double(power) + 1.0) : 0.0;
}

/// What the limit leaves to data.
std::uint64_t usable(std::uint64_t bytes) {
    return std::max(bytes - std::min(bytes, kProgramPages), kLeastData);
}

void limit_data(std::uint64_t bytes, int threads) {
    struct rlimit limit = {};
    const bool known = ::getrlimit(RLIMIT_DATA, &limit) == 0;
    const std::uint64_t stacks = kStack * static_cast<std::uint64_t>(std::max(threads, 1));
    limit.rlim_cur = std::min<rlim_t>(bytes + stacks, limit.rlim_max);
    if (known && ::setrlimit(RLIMIT_DATA, &limit) == 0) return;
    throw Error(ExitCode::kBudget,
                "the system does not hold programs to a limit of memory; leave "
                "--memory-limit out");
}

}  // namespace

std::uint64_t parse_size(const std::string& text) {
    double number = 0.0;
    const char* end = text.data() + text.size();
    const auto parsed = std::from_chars(text.data(), end, number, std::chars_format::fixed);
    std::string unit(parsed.ptr, end);
    unit.erase(0, unit.find_first_not_of(' ') == std::string::npos ? unit.size()
                                                                   : unit.find_first_not_of(' '));
    const double bytes = number * unit_bytes(unit);
    if (parsed.ec != std::errc() || !(bytes >= 1.0) || !(bytes < 1e18)) {
        throw Error(ExitCode::kUsage,
                    fmt::format("'{}' is no size; write it as 512M, 8G or 1.5GiB", text));
    }
    return static_cast<std::uint64_t>(bytes);
}

void limit_memory(std::uint64_t bytes, int threads) {
    if (bytes == 0) return;
    forget_loader_pages();
    const std::uint64_t least = resident_bytes() + kLeastData;
    if (bytes < least) {
        throw Error(ExitCode::kBudget,
                    fmt::format("a limit of {} is too small: the program itself takes {} MB; "
                                "raise --memory-limit",
                                format_bytes(bytes), least / 1'000'000 + 1));
    }
    limit_data(usable(bytes), threads);
}

void limit_memory_beside_pages(std::uint64_t bytes, int threads) {
    constexpr int kWatch = 1;  // the thread that gives pages back
    limit_data(usable(bytes) * 3 / 4, threads + kWatch);
}

}  // namespace glowworm
