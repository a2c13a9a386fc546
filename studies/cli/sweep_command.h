// What `marti sweep` does with its arguments.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace marti::studies::cli {

struct SweepArguments {
  std::string config;
  std::vector<std::string> assignments;
  std::vector<std::string> axes;  ///< as in studies/sweep/plan/axis_argument.h
  std::string directory;
  unsigned threads = 0;
  std::string share;  ///< as "3/8"; empty: what the launcher says
  bool plan_only = false;
  bool quiet = false;
  bool json = false;
  std::string best;
  std::optional<double> budget;
};

/// Runs the command; `print` writes to standard output. Throws UserError.
void sweep_command(const SweepArguments& arguments, void (*print)(const std::string&));

}  // namespace marti::studies::cli
