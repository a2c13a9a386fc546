// [suite] of a configuration.
#pragma once

#include <string>
#include <vector>

#include "sim/config.h"
#include "sim/error.h"
#include "studies/sweep/plan/question.h"

namespace marti::studies::suite {

struct SuiteScene {
  std::string name;     ///< 1 to 60 printable ASCII characters without quotation marks and backslashes
  std::string source;   ///< from any directory (scenes::source_from)
  std::string found;    ///< where it can be found; may be empty
  std::string missing;  ///< why it is left out; empty: it is there
  int line = 0;         ///< of the file, of its source
};

struct SuiteFile {
  std::string baseline;
  sim::Place place;  ///< of the baseline, for messages
  std::vector<SuiteScene> scenes;
};

/// Reads the free section "suite" and looks for the scenes. Throws UserError naming file, line and key, also
/// for two scenes of one name or source.
[[nodiscard]] SuiteFile read_suite(const sim::Config& config);

/// What a suite asks of its points: each machine's speed-up over the baseline, and its energy, energy times
/// delay, misses and traffic as shares of the baseline's, for each scene, with geometric means.
[[nodiscard]] sweep::Question question_of(const SuiteFile& suite);

}  // namespace marti::studies::suite
