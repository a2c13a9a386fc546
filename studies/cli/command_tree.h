// Questions about the program's commands and options that CLI11 has no name for.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace marti::studies::cli {

/// Whether the option takes the word after it as its value.
[[nodiscard]] inline bool takes_value(const CLI::Option& option) {
  return option.get_items_expected_max() > 0;
}

/// The commands below `app`, without groups of options, which have no name.
[[nodiscard]] inline std::vector<const CLI::App*> subcommands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_name().empty(); });
}

/// The command of that name below `app`; null if no command has it.
[[nodiscard]] inline const CLI::App* find_subcommand(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : subcommands_of(app)) {
    if (command->get_name() == name) {
      return command;
    }
  }
  return nullptr;
}

}  // namespace marti::studies::cli
