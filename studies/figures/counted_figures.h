// The counted figures of a timed machine: integers, summed over its nodes, clusters and banks, of peaks the
// largest. They are the columns of table `results` of a sweep's store, and fields of `figures.machine` in
// result.json.
#pragma once

#include <span>
#include <string_view>

#include "processors/replay/replay.h"
#include "studies/figures/figure_parts.h"
#include "studies/figures/machine_totals.h"

namespace marti::studies::figures {

/// In order. The first is "end", the frame time in ps.
[[nodiscard]] std::span<const FigureEntry> counted_figures();

/// One value for each of counted_figures(), whatever the machine.
[[nodiscard]] Counts counts_of(const processors::machine::MachineConfig& machine,
                               const processors::replay::MachineResult& result);
/// `totals` must be totals_of(result).
[[nodiscard]] Counts counts_of(const processors::machine::MachineConfig& machine,
                               const processors::replay::MachineResult& result, const MachineTotals& totals);

/// The value of the counted figure of this name. Throws InternalError when there is none.
[[nodiscard]] std::optional<Count> count_of(const Counts& counts, std::string_view figure);

}  // namespace marti::studies::figures
