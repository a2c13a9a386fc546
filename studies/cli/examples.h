// Two calls of each command, for its help.
#pragma once

#include <CLI/CLI.hpp>

namespace marti::studies::cli {

/// Gives each command below `app` its examples, as the end of its help.
void add_examples(CLI::App& app);

}  // namespace marti::studies::cli
