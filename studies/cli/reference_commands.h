// The commands that tell people and shells about the program itself: config, figures,
// completion, man, help.
#pragma once

#include <string>
#include <vector>

#include "sim/schema.h"

namespace CLI {
class App;
}

namespace marti::studies::cli {

/// Every key of every command.
[[nodiscard]] sim::Schema all_keys();

/// What `config`, `figures` and `help` are given.
struct ReferenceArguments {
  bool markdown = false;
  bool json = false;
  std::string key;
  std::vector<std::string> command;
};

/// Adds the commands, which print by `print`. `arguments` must live as long as `app` does.
void add_reference_commands(CLI::App& app, ReferenceArguments& arguments, void (*print)(const std::string&));

}  // namespace marti::studies::cli
