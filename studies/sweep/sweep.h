// `marti sweep`: every machine of a configuration's [sweep], timed once, in a store that can be resumed.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/config.h"
#include "sim/memory_budget.h"
#include "studies/limits/limit_table.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/store/sweep_reader.h"

namespace marti::studies::sweep {

class Ranks;

struct SweepOptions {
  std::filesystem::path directory;  ///< results.sqlite and points.csv go there
  unsigned threads = 0;             ///< machines timed at a time; 0: as many as the computer has
  bool terminal = false;            ///< progress as a bar
  bool quiet = false;               ///< no progress
  Ranks* ranks = nullptr;           ///< the processes that share the work, this being rank 0; null: none
  std::string configuration;        ///< for them: the text of the file
};

/// What is known of the sweep before it runs, including what its store holds already. Writes nothing. Throws
/// UserError when the store cannot be read.
[[nodiscard]] SweepOutlook look_ahead(const SweepPlan& plan, const SweepOptions& options);

struct SweepReport {
  std::size_t timed = 0;   ///< machines timed now, not before
  std::size_t traced = 0;  ///< frames traced now
  double seconds = 0.0;    ///< of real time
  std::filesystem::path store;
  std::filesystem::path points;                  ///< the table as CSV
  std::unique_ptr<const SweepReader> reader;     ///< of the store as the sweep has left it
  std::optional<limits::LimitedPoints> limited;  ///< its points with what limits them
};

/// Runs the part of the plan that is not in the store yet. `announce` is called with the plan as text before
/// anything is done. A program that is ended by a signal says what is saved and exits with 128 + signal.
/// Throws UserError; what is done by then is saved.
/// `prices` rank what limits points.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options, const sim::MemoryBudget& limit,
                      const std::optional<keys::Prices>& prices,
                      const std::function<void(const std::string&)>& announce);

/// What a rank makes of the configuration.
struct JoinedSweep {
  SweepPlan plan;
  sim::MemoryBudget memory;
};

/// The part of a rank that does not hold the store: works until rank 0 says that all is done.
void join_sweep(Ranks& ranks, const SweepOptions& options,
                const std::function<JoinedSweep(const std::string& configuration)>& read);

}  // namespace marti::studies::sweep
