// The configuration of `marti study paper`: the keys of a run, and a section of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "sim/schema.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::paper {

/// One of the machines whose tree is built while it is used: tables 2 to 5 of the paper.
struct PaperRun {
  std::string scene;
  std::uint32_t depth = 2;  ///< longest chain of rays, the eye ray being 1

  bool operator==(const PaperRun&) const = default;
};

/// "teapot:12:pot at depth 2".
[[nodiscard]] std::string name_of(const PaperRun& run);

struct PaperConfig {
  keys::FrameConfig frame;  ///< what all runs share; scene and depth are a run's own
  processors::machine::MachineConfig machine;
  std::vector<std::string> scenes;     ///< of table 1
  std::vector<PaperRun> runs;          ///< of tables 2 onwards, one each
  std::vector<std::uint32_t> levels;   ///< initial levels to try, ascending, each once; none beyond max_level
  std::vector<double> rules;           ///< k of the rules to try
  std::uint32_t host_repetitions = 0;  ///< of each measurement on the host; 0: none is made

  /// The frame of one run.
  [[nodiscard]] keys::FrameConfig frame_of(const PaperRun& run) const;
};

void declare_paper_keys(sim::Schema& schema);

/// The schema of `marti study paper`.
[[nodiscard]] sim::Schema paper_schema();

/// Throws UserError naming file, line and key: what read_frame and read_machine refuse; lists that are empty
/// or do not match; a key of a run that this study sets itself.
[[nodiscard]] PaperConfig read_paper(sim::Config& config);

}  // namespace marti::studies::paper
