// What the program prints for other programs.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/cli/shell.h"

namespace marti::test {

/// What the program, which must succeed, prints for these arguments and --json.
inline nlohmann::json printed_json(const std::string& arguments) {
  const Outcome outcome = marti(arguments + " --json");
  EXPECT_EQ(outcome.status, 0) << outcome.output;
  return nlohmann::json::parse(outcome.output);
}

}  // namespace marti::test
