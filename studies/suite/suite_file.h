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
  std::string source;   ///< as scene.source has it
  std::string found;    ///< where it can be found; may be empty
  std::string missing;  ///< why it is left out; empty: it is there
  int line = 0;         ///< of the file, of its source
};

struct SuiteFile {
  std::string baseline;
  sim::Place place;  ///< of the baseline, for messages
  std::vector<SuiteScene> scenes;
};

/// What a suite has no result of, and why.
struct LeftOut {
  std::string scene;
  std::string machine;  ///< empty: all of the scene
  std::string reason;
};

/// What a suite compares: each other machine with the baseline on each of the scenes.
struct Compared {
  std::vector<const SuiteScene*> scenes;  ///< that the baseline is timed on
  std::vector<std::string> machines;      ///< but the baseline; not each need have a result of each scene
  std::vector<LeftOut> left_out;
};

/// Reads the free section "suite" and looks for the scenes. Throws UserError naming file, line and key, also
/// for two scenes of one name or source.
[[nodiscard]] SuiteFile read_suite(const sim::Config& config);

/// What a suite asks of its points: each machine's speed-up over the baseline, and its energy, energy times
/// delay, misses and traffic as shares of the baseline's, for each scene, with geometric means over the
/// scenes that it has results of; and what is left out.
[[nodiscard]] sweep::Question question_of(const SuiteFile& suite, const Compared& compared);

}  // namespace marti::studies::suite
