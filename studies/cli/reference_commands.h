// The commands that tell people and shells about the program itself: config, figures,
// completion, man.
#pragma once

#include <string>

#include "sim/schema.h"

namespace CLI {
class App;
}

namespace marti::studies {

/// Every key of every command.
[[nodiscard]] sim::Schema all_keys();

/// Adds the commands, which print by `print`. `markdown` is where `config` and `figures` keep their option:
/// it must live as long as `app` does.
void add_reference_commands(CLI::App& app, bool& markdown, void (*print)(const std::string&));

}  // namespace marti::studies
