// The commands that tell people and shells about the program itself: config, figures,
// completion, man, help.
#pragma once

#include <span>
#include <string>

#include "sim/schema.h"

namespace CLI {
class App;
}

namespace marti::studies {

/// Every key of every command.
[[nodiscard]] sim::Schema all_keys();

/// What `config` and `figures` are given.
struct ReferenceArguments {
  bool markdown = false;
  bool json = false;
  std::string key;
};

/// What `marti help WORDS` prints. Throws UserError when the words name no command.
[[nodiscard]] std::string help_on(const CLI::App& app, std::span<const std::string> words);

/// Adds the commands, which print by `print`. `arguments` must live as long as `app` does.
void add_reference_commands(CLI::App& app, ReferenceArguments& arguments, void (*print)(const std::string&));

}  // namespace marti::studies
