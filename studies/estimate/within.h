// `marti run --within`: the cheapest answer that is good enough, with its error bars.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "processors/machine/machine_config.h"
#include "processors/program/work_log.h"
#include "sim/config.h"
#include "studies/estimate/simulator_figures.h"
#include "studies/keys/frame_keys.h"
#include "studies/run/run_result.h"

namespace marti::studies {

/// "2%", "2 %" or "0.02". Throws UserError unless it is from 0 to 100 %.
[[nodiscard]] double parse_tolerance(std::string_view text);

/// The reason why only exact replay is known to be good for a frame, by what the study measured; std::nullopt
/// when a cheaper method is.
[[nodiscard]] std::optional<std::string> outside_measured(const FrameConfig& frame);

/// The reason why only exact replay is known to be good for a machine, by what the study measured;
/// std::nullopt when a cheaper method is. `packets`: of the frame.
[[nodiscard]] std::optional<std::string> outside_measured(const processors::MachineConfig& machine,
                                                          std::uint64_t packets);

/// An estimate that is good enough.
struct EstimatedRun {
  std::size_t method = 0;  ///< index into simulator_methods(); never the exact one
  std::uint32_t nodes_to = 0;
  Estimate machine;  ///< half-widths: the method's own and what was measured
  Estimate one_node;
};

/// By the cheapest method whose half-widths of frame time and speed-up, its own and the measured ones
/// together, are at most `tolerance`. If a sample's own half-widths turn out too wide, or the analytic model
/// finds the interconnect busy, the next method is tried. std::nullopt when only exact replay is left.
/// outside_measured() must be std::nullopt for the machine.
[[nodiscard]] std::optional<EstimatedRun> estimate_within(const processors::WorkLog& log,
                                                          const processors::MachineConfig& machine,
                                                          double tolerance);

/// Runs a configuration and gives what to print: an estimate with error bars, or the summary of an exact run
/// and the reason for it; as JSON, an object with `estimate`, or the exact run's result. `exact`: how an
/// exact run is made. Throws UserError as run() does.
[[nodiscard]] std::string run_within(sim::Config& config, double tolerance, bool json, RunOptions exact);

}  // namespace marti::studies
