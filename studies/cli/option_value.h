// Command-line options whose values are read like those of keys: a wrong one gets the message of a key.
#pragma once

#include <CLI/CLI.hpp>

#include "sim/schema.h"

namespace marti::studies::cli {

/// Has the option take what such a key takes: a number in its range, or one of its choices. The name of the
/// key does not matter. Reading another value throws UserError with the option, the value and what it must
/// be.
CLI::Option* takes_value(CLI::Option* option, const sim::Key& key);

}  // namespace marti::studies::cli
