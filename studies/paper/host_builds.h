// Tables 2 to 5 on the host: real seconds of the octree that is built while rays are traced.
#pragma once

#include <cstdint>
#include <vector>

#include "studies/paper/building_table.h"
#include "studies/paper/paper_keys.h"
#include "studies/paper/traced_run.h"
#include "studies/tables/table.h"

namespace marti::studies::paper {

/// One initial level. Seconds are the least of the configured number of repetitions.
struct HostOutcome {
  InitialLevel initial;
  double build_seconds = 0.0;   ///< building to the initial level, on all host threads
  double render_seconds = 0.0;  ///< the frame, on all host threads
  std::uint64_t nodes = 0;      ///< what the frame leaves
  std::uint64_t partial = 0;
  std::uint64_t bytes = 0;  ///< host memory of nodes and lists
};

/// Builds and renders each initial level of a run. One after the other: they are timed.
[[nodiscard]] std::vector<HostOutcome> measure_host(const PaperConfig& config, const TracedRun& run);

/// "host_table2" for the first run, and so on.
[[nodiscard]] tables::Table host_building_table(std::size_t index, const PaperRun& run,
                                                std::span<const HostOutcome> outcomes);

}  // namespace marti::studies::paper
