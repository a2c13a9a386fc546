// The message for a wrong command line: CLI11 finds the error, this file says what would be right.
#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace marti::studies::cli {

/// One line without a line break: the command, what is wrong with it, and what would be right. `words` are
/// the arguments of the program.
[[nodiscard]] std::string command_error(const CLI::App& app, const CLI::ParseError& error,
                                        std::span<const std::string> words);

}  // namespace marti::studies::cli
