// `marti sweep`: every machine of a configuration's [sweep], timed once, in a store that can be resumed.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "sim/config.h"
#include "sim/memory_budget.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "studies/sweep/share.h"
#include "studies/sweep/store/sweep_reader.h"

namespace marti::studies::sweep {

struct SweepOptions {
  std::filesystem::path directory;  ///< results.sqlite and points.csv go there
  unsigned threads = 0;             ///< machines timed at a time; 0: as many as the computer has
  bool terminal = false;            ///< progress as a bar
  bool quiet = false;               ///< no progress
  std::optional<Share> share{};     ///< times only this part of the machines
};

/// Leaves out of a plan that leaves points out those whose machine, or the machine they are measured against,
/// cannot be run on its scene: what is known only of a structure and a work log. Each machine without a
/// result in `directory`, which may be empty, is run on a small image of its frame; on given rays or a saved
/// log none is. Throws UserError when no point is left, or the machine of [sweep.compare] is at fault.
void leave_out_unfit(SweepPlan& plan, const std::filesystem::path& directory);

/// What is known of the sweep before it runs, including what its store holds already. Writes nothing. Throws
/// UserError when the store cannot be read.
[[nodiscard]] SweepOutlook look_ahead(const SweepPlan& plan, const SweepOptions& options);

struct SweepReport {
  std::size_t timed = 0;         ///< machines timed now, not before
  std::size_t traced = 0;        ///< frames traced now
  double seconds = 0.0;          ///< of real time
  std::filesystem::path store;   ///< or the part with a share of it; empty: the share was done already
  std::filesystem::path points;  ///< the table as CSV
  bool merged = false;           ///< another process has merged that part
  /// Of the store as the sweep has left it; null when other shares are not done yet, or another process has
  /// merged them.
  std::unique_ptr<const SweepReader> reader;
};

/// Runs the part of the plan that is not in the store yet, nor in its parts, which are merged into it. With a
/// share only that is timed, in a part of the store, and merged with the others by the process that ends
/// last. `announce` is called with the plan as text before anything is done. A program that is ended by a
/// signal says what is saved and exits with 128 + signal. Throws UserError, and sim::Stopped after stop() of
/// the meter of a frame that is being traced, or replayed (FrameConfig::meter); what is done by then is
/// saved.
SweepReport run_sweep(const SweepPlan& plan, const SweepOptions& options, const sim::MemoryBudget& limit,
                      const std::function<void(const std::string&)>& announce);

}  // namespace marti::studies::sweep
