// A sweep on several processes: each times its share of the machines. What is to be done is known before it
// begins, so it is dealt like cards, and the processes need not speak with each other.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "studies/sweep/plan/sweep_plan.h"

namespace marti::studies::sweep {

struct Share {
  std::uint32_t number = 1;  ///< from 1
  std::uint32_t of = 1;

  /// "3 of 8".
  [[nodiscard]] std::string text() const;
};

/// The share that "3/8" names. Throws UserError.
[[nodiscard]] Share share_named(const std::string& text);

/// The share of this process by what its launcher (Open MPI's or MPICH's mpirun, srun) has left in the
/// environment; std::nullopt unless it has started several processes. That a batch job of Slurm has several
/// tasks does not count: only srun starts them.
[[nodiscard]] std::optional<Share> share_of_launcher();

/// How many of those processes are on this computer, by the launcher; 1 when there was none.
[[nodiscard]] std::uint32_t processes_beside();

/// So many threads make use of the processors that this process may run on, shared with the processes beside
/// it.
[[nodiscard]] unsigned threads_beside();

/// The part of a plan that one process times: of its machines, without those that are `done`, and their
/// frames; it has no points. All processes together have each machine once. They are dealt from the most
/// expensive to the cheapest, by what can be told before; machines of one timing stay together, and those of
/// one frame where there are many frames.
[[nodiscard]] SweepPlan part_of(const SweepPlan& plan, Share share,
                                const std::function<bool(const SweepMachine&)>& done);

}  // namespace marti::studies::sweep
