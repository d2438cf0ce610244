#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace glowworm {

/// Reads --config. Keys are the long names of flags; those at the top are for whatever command
/// runs, those in a table of its name ([convert]) only for it, and tables of other commands are
/// passed over. Throws CLI::ConfigError for a file that is no TOML and for a key that the command
/// does not know.
class ConfigFile : public CLI::ConfigTOML {
  public:
    explicit ConfigFile(CLI::App& app) : app_(app) {}
    std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

  private:
    CLI::App& app_;
};

}  // namespace glowworm
