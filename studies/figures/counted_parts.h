// The counted figures of parts that not every machine has: they have no value where it has not.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "processors/replay/replay.h"
#include "studies/figures/figure_parts.h"
#include "studies/figures/machine_totals.h"

namespace marti::studies::figures {

/// The value of a part, if there is one.
template <class Value>
std::optional<Value> only(bool there, Value value) {
  return there ? std::optional(value) : std::nullopt;
}

/// Of the waits at queues: count, sum, longest and percentiles.
void add_waits(FigureParts& parts, const std::string& prefix, std::string_view whose,
               const std::optional<memory::WaitStatistics>& waits);
/// How short the frame can be at best, and what says from how many nodes on its busiest queue is full.
void add_bounds(FigureParts& parts, const processors::machine::MachineConfig& machine,
                const processors::replay::MachineResult& result, const MachineTotals& totals);
/// Of rays that move from node to node.
void add_flow_figures(FigureParts& parts, const processors::machine::MachineConfig& machine,
                      const processors::replay::MachineResult& result, const MachineTotals& totals);
/// Of a tree that is built.
void add_build_figures(FigureParts& parts, const processors::replay::MachineResult& result);
/// Of the second level, of SIMT nodes, of contexts and prefetching.
void add_cache_figures(FigureParts& parts, const processors::replay::MachineResult& result,
                       const MachineTotals& totals);
/// What is counted only when it is asked for.
void add_asked_figures(FigureParts& parts, const processors::machine::MachineConfig& machine,
                       const processors::replay::MachineResult& result);

}  // namespace marti::studies::figures
