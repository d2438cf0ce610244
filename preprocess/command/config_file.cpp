#include "preprocess/command/config_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace glowworm {
namespace {

std::string text_of(const toml::node& value) {
    if (const auto text = value.value_exact<std::string>()) return *text;
    std::ostringstream words;
    if (const auto flag = value.value_exact<bool>()) {
        words << (*flag ? "true" : "false");
    } else if (const auto whole = value.value_exact<std::int64_t>()) {
        words << *whole;
    } else if (const auto number = value.value_exact<double>()) {
        words << fmt::format("{}", *number);
    } else {
        throw CLI::ConfigError(
            "values in the configuration are texts, numbers, true, false or "
            "lists of them");
    }
    return words.str();
}

/// Adds the keys of `table`, sub-tables excepted, as flags of `command`.
void add_flags(const toml::table& table, const CLI::App& command,
               std::vector<CLI::ConfigItem>& items) {
    for (const auto& [key, value] : table) {
        if (value.is_table()) continue;
        CLI::ConfigItem& item = items.emplace_back();
        item.parents = {command.get_name()};
        item.name = std::string(key.str());
        if (command.get_option_no_throw("--" + item.name) == nullptr &&
            command.get_option_no_throw(item.name) == nullptr) {
            throw CLI::ConfigError(fmt::format("the configuration's key '{}' is no flag of '{}'",
                                               item.name, command.get_name()));
        }
        if (const toml::array* list = value.as_array()) {
            for (const toml::node& one : *list)
                item.inputs.push_back(text_of(one));
        } else {
            item.inputs.push_back(text_of(value));
        }
    }
}

class ConfigFile : public CLI::ConfigTOML {
  public:
    explicit ConfigFile(CLI::App& app) : app_(app) {}
    std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

  private:
    CLI::App& app_;
};

std::vector<CLI::ConfigItem> ConfigFile::from_config(std::istream& input) const {
    toml::table table;
    try {
        table = toml::parse(input);
    } catch (const toml::parse_error& error) {
        throw CLI::ConfigError(fmt::format("the configuration is not TOML: line {}: {}",
                                           error.source().begin.line, error.description()));
    }
    const std::vector<CLI::App*> selected = app_.get_subcommands();
    std::vector<CLI::ConfigItem> flags;
    if (selected.empty()) return flags;
    for (const auto& [key, value] : table) {
        const std::string name(key.str());
        const auto commands = app_.get_subcommands(
            [&](const CLI::App* command) { return command->get_name() == name; });
        if (value.is_table() && commands.empty()) {
            throw CLI::ConfigError(
                fmt::format("the configuration's table '{}' is no command", name));
        }
    }
    // What comes first counts, so the command's own table goes before what is for all.
    const std::string& name = selected.front()->get_name();
    if (const toml::table* own = table[name].as_table()) add_flags(*own, *selected.front(), flags);
    add_flags(table, *selected.front(), flags);
    return flags;
}

}  // namespace

std::shared_ptr<CLI::Config> config_file(CLI::App& app) {
    return std::make_shared<ConfigFile>(app);
}

}  // namespace glowworm
