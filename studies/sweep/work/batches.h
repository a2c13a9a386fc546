// Machines of a sweep whose logs are stripped in one pass (processors/walk/stripped_log.h).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

/// Machines of one frame with one StrippedLog::key_of.
struct MachineBatch {
  std::size_t frame = 0;
  std::string key;  ///< empty: their log cannot be stripped
  /// Indices into SweepPlan::machines. Those of one timing stand together.
  std::vector<std::size_t> machines;
  std::vector<std::uint32_t> ways;  ///< of the stripped logs of all of them, ascending
};

/// `machines` of the plan, sorted into batches; those of a batch, and of one timing, are in the order of
/// `machines`.
[[nodiscard]] std::vector<MachineBatch> batches_of(const SweepPlan& plan,
                                                   std::span<const std::size_t> machines);

/// Whether a pass that strips the batch's log takes less time than it saves: for two machines where LRU
/// caches are among them, for four where only references to the newest line can be taken out.
[[nodiscard]] bool pays_to_strip(const MachineBatch& batch);

}  // namespace marti::studies::sweep
