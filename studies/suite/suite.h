// `marti study suite FILE`: machines against a baseline over a list of scenes, as the table that papers
// print.
//
// A suite file is a sweep's configuration (studies/sweep) whose named points are the machines, with
//
//   [suite]
//   baseline = "bus"                # one of [sweep.points]
//
//   [[suite.scene]]
//   name = "pot"                    # in tables
//   source = "teapot:12"            # as scene.source, relative to the file
//   found = "https://..."           # where it is, for who lacks it
//   licence = "CC BY 4.0"
//   sha256 = "..."                  # of a source that is one file
//
// Everything else is the sweep's: its store, its going on after a kill, its page.
#pragma once

#include <string>
#include <vector>

namespace marti::studies::suite {

struct SuiteArguments {
  std::string config;
  std::vector<std::string> assignments;
  std::string directory;
  bool quiet = false;  ///< no progress
};

/// Times all machines on the scenes that are there, and writes results.sqlite, points.csv, suite.csv,
/// suite.tex and the page report.html to the directory. Scenes that are missing, have another checksum or
/// cannot be read are named and left out, as is a machine on a scene on which it cannot be built; where there
/// are any, suite_left_out.csv and the page list them. Throws UserError as the sweep does, for a file without
/// such a table, and when nothing is left to compare.
void suite_command(const SuiteArguments& arguments, void (*print)(const std::string&));

}  // namespace marti::studies::suite
