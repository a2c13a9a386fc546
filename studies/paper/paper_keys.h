// The configuration of `marti study paper`: the keys of a frame, and a section of its own.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/config.h"
#include "sim/schema.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::paper {

/// One of the frames that are traced: figures 2 and 3 of the paper.
struct PaperRun {
  std::string scene;
  std::uint32_t depth = 2;  ///< longest chain of rays, the eye ray being 1

  bool operator==(const PaperRun&) const = default;
};

/// "teapot:12:pot at depth 2".
[[nodiscard]] std::string name_of(const PaperRun& run);

struct PaperConfig {
  keys::FrameConfig frame;          ///< what all runs share; scene and depth are a run's own
  std::vector<std::string> scenes;  ///< of table 1
  std::vector<PaperRun> runs;       ///< of the figures, one each
  std::vector<double> rules;        ///< k of the rules to try

  /// The frame of one run.
  [[nodiscard]] keys::FrameConfig frame_of(const PaperRun& run) const;
};

void declare_paper_keys(sim::Schema& schema);

/// The schema of `marti study paper`.
[[nodiscard]] sim::Schema paper_schema();

/// Throws UserError naming file, line and key: what read_frame refuses; lists that are empty
/// or do not match; a key of a run that this study sets itself.
[[nodiscard]] PaperConfig read_paper(sim::Config& config);

}  // namespace marti::studies::paper
