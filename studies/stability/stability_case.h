// A case of the stability study: something of the user's scene or machine that breaks careless ray tracers or
// simulators, and an oracle that would notice.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "accel/structure.h"
#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "processors/replay/replay.h"
#include "scenes/scene.h"
#include "studies/keys/frame_keys.h"

namespace marti::studies::stability {

/// What is tried: a scene with its structure, and a machine with a small frame of that scene.
struct Subject {
  keys::FrameConfig frame;
  scenes::Scene scene;
  std::shared_ptr<const accel::TriangleSet> triangles;  ///< of the scene, at least one primitive
  std::shared_ptr<const accel::Structure> structure;    ///< over them
  std::shared_ptr<const processors::program::WorkLog> log;
  processors::machine::MachineConfig machine;
  std::uint32_t rays = 0;   ///< of each case of rays
  std::uint32_t nodes = 0;  ///< of each cluster of the largest machine
};

/// What a case found. It passes when its oracle objects to nothing; so NaN fails.
struct CaseOutcome {
  std::string figure;      ///< for people
  double objection = 0.0;  ///< how many rays or machines are wrong
  bool tried = true;       ///< false: the subject has nothing that the case could try

  [[nodiscard]] bool passed() const { return !tried || objection <= 0.0; }
  [[nodiscard]] std::string_view verdict() const {
    return !tried ? "not measured" : passed() ? "pass" : "FAIL";
  }
};

enum class CaseGroup : std::uint8_t { scene, machine };

struct StabilityCase {
  std::string id;  ///< lower-case letters, digits and '-'
  CaseGroup group = CaseGroup::scene;
  std::string risk;    ///< what could go wrong
  std::string oracle;  ///< what must hold instead
  std::function<CaseOutcome(const Subject&)> run;
};

/// Counts what was tried and what went wrong.
struct Tally {
  std::uint64_t wrong = 0;
  std::uint64_t of = 0;

  void add(bool good) {
    wrong += good ? 0U : 1U;
    ++of;
  }
};

/// None may be wrong: "0 of 20,000 WHAT". A case that tried nothing fails.
[[nodiscard]] CaseOutcome none_wrong(const Tally& tally, std::string_view what);

/// The outcome of a case for which the subject has nothing to try.
[[nodiscard]] CaseOutcome not_tried(std::string_view why);

/// Runs a case. An exception from it becomes a failure with the exception's message.
[[nodiscard]] CaseOutcome run_case(const StabilityCase& one, const Subject& subject);

/// All cases, in the order of the table.
[[nodiscard]] std::vector<StabilityCase> stability_cases();

/// Whether `long_one` is `short_one` with every time multiplied by `factor`, and everything else equal;
/// `events`: their number too.
[[nodiscard]] bool is_stretched(const processors::replay::MachineResult& short_one,
                                const processors::replay::MachineResult& long_one, std::int64_t factor,
                                bool events);

// The cases of each file; they append.
void add_ray_cases(std::vector<StabilityCase>& cases);
void add_machine_cases(std::vector<StabilityCase>& cases);

}  // namespace marti::studies::stability
