#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

constexpr std::size_t kMostDamaged = 400;  // of each kind, per file

void give(std::string_view content) {
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(content.data()), content.size());
}

/// The file as it is, cut off at places all over it, and with single bits flipped.
std::size_t replay(std::string content) {
    give(content);
    std::size_t given = 1;
    const std::size_t step = std::max<std::size_t>(1, content.size() / kMostDamaged);
    for (std::size_t at = 0; at < content.size(); at += step) {
        give(std::string_view(content).substr(0, at));
        const char whole = content[at];
        content[at] = static_cast<char>(whole ^ (1 << (at / step) % 8));
        give(content);
        content[at] = whole;
        given += 2;
    }
    return given;
}

}  // namespace

/// Gives every file below the folders named to the fuzz target, whole and damaged, for compilers
/// without libFuzzer. Fails where there is none.
int main(int argc, char** argv) {
    std::size_t given = 0;
    for (int i = 1; i < argc; ++i) {
        for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[i])) {
            if (!entry.is_regular_file()) continue;
            std::ifstream stream(entry.path(), std::ios::binary);
            given += replay({std::istreambuf_iterator<char>(stream), {}});
        }
    }
    std::printf("%zu inputs replayed\n", given);
    return given > 0 ? 0 : 1;
}
