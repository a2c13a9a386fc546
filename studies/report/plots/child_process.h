// Other programs, started without a shell.
#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <vector>

namespace marti::studies::report {

struct ChildProcess {
  std::vector<std::string> command;      ///< the program, found by PATH, and its arguments
  std::string package;                   ///< the Debian package that has it, for the message
  std::vector<std::string> environment;  ///< NAME=VALUE, added to our environment or in place of its own
  std::chrono::seconds limit;            ///< after which the program is killed
};

/// Runs the program with `input` as its standard input and returns its standard output. A signal that ends
/// this program ends the child, too. Throws UserError when there is no such program, when it does not end
/// with status 0 (the message passes on what it says), when it takes longer than its limit, or when it writes
/// more than `most` bytes.
std::string run_child(const ChildProcess& child, std::string_view input, std::size_t most = 256U << 20U);

}  // namespace marti::studies::report
