#pragma once

#include <memory>

namespace CLI {
class App;
class Config;
}  // namespace CLI

namespace glowworm {

/// What reads --config for `app`. Keys are the long names of flags; those at the top are for
/// whatever command runs, those in a table of its name ([convert]) only for it, and tables of other
/// commands are passed over. Throws CLI::ConfigError for a file that is no TOML and for a key that
/// the command does not know.
std::shared_ptr<CLI::Config> config_file(CLI::App& app);

}  // namespace glowworm
