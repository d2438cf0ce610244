#include "preprocess/command/finished.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>

#include "preprocess/pipeline/hash.h"
#include "preprocess/pipeline/up_to_date.h"
#include "preprocess/provenance.h"
#include "preprocess/read/read_scans.h"

namespace glowworm {
namespace {

constexpr std::string_view kHowToWork[] = {
    "output",       "json",     "progress", "quiet",  "verbose", "log-file", "threads",  "force",
    "memory-limit", "temp-dir", "dry-run",  "resume", "config",  "help",     "help-all", "version"};

constexpr std::string_view kPictures[] = {"plot", "report"};

template <typename Names>
bool is_one_of(const CLI::Option& option, const Names& names) {
    return std::ranges::any_of(
        names, [&](std::string_view name) { return option.check_lname(std::string(name)); });
}

}  // namespace

Origin::Origin(const CLI::App& command) {
    Hash words;
    words.add(command.get_name()).add(GLOWWORM_VERSION);
    for (const CLI::Option* option : command.get_options()) {
        if (is_one_of(*option, kHowToWork) || option->count() == 0) continue;
        words.add(option->get_name());
        for (const std::string& word : option->results()) {
            words.add(word);
            std::error_code ignored;
            if (is_one_of(*option, kPictures)) {
                side_output_.emplace_back(word);
            } else if (std::filesystem::is_regular_file(word, ignored)) {
                files_.emplace_back(word);
            } else if (std::filesystem::is_directory(word, ignored)) {
                std::ranges::move(find_scan_files(std::vector<std::filesystem::path>{word}),
                                  std::back_inserter(files_));
            }
        }
    }
    words_ = words.hex();
    state_ = state_of(files_, words_);
    if (state_.empty()) content_ = content();  // files that were written just now
}

std::string Origin::content() const {
    Hash hash;
    hash.add(words_);
    for (const InputFile& input : describe_inputs(files_))
        hash.add(input.file).add(input.hash);
    return hash.hex();
}

bool Origin::made(const std::filesystem::path& output) const {
    const auto is_there = [](const std::filesystem::path& path) {
        std::error_code ignored;
        return std::filesystem::exists(path, ignored);
    };
    if (!is_there(output) || !std::ranges::all_of(side_output_, is_there)) return false;
    if (remembers(output, Record::kState, state_)) return true;
    if (!remembers(output, Record::kContent, content())) return false;
    remember_as(output, Record::kState, state_);
    return true;
}

void Origin::remember(const std::filesystem::path& output) const {
    const std::string now = content();
    const bool same = state_.empty() ? now == content_ : state_of(files_, words_) == state_;
    if (!same) return;
    remember_as(output, Record::kContent, now);
    remember_as(output, Record::kState, state_);
}

}  // namespace glowworm
