// `marti run --within`: an answer with error bars from a sample of the frame, where that is cheaper than an
// exact one.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "processors/machine/machine_config.h"
#include "sim/config.h"
#include "studies/estimate/sample_machine.h"
#include "studies/estimate/sampled_frame.h"
#include "studies/keys/frame_keys.h"
#include "studies/run/run_result.h"

namespace marti::studies::estimate {

/// "2%", "2 %" or "0.02". Throws UserError unless it is from 0 to 100 %.
[[nodiscard]] double parse_tolerance(std::string_view text);

/// The reason why a frame is not sampled; std::nullopt when it may be.
[[nodiscard]] std::optional<std::string> not_sampled(const keys::FrameConfig& frame);
/// The reason why a machine's frame is not sampled; std::nullopt when it may be.
[[nodiscard]] std::optional<std::string> not_sampled(const processors::machine::MachineConfig& machine);

/// An estimate that is good enough.
struct EstimatedRun {
  SampledRun sampled;         ///< half-widths: from the sample, plus the measured errors
  double use_to = 1.0;        ///< the class of load (measured_errors.h) whose measured errors were added
  std::uint64_t windows = 0;  ///< drawn
  std::uint64_t of_windows = 0;
  std::uint64_t packets = 0;  ///< of the windows drawn
  std::uint64_t of_packets = 0;
  TracedPart traced;
};

/// An estimate, or the reason why only an exact run will do.
struct WithinAnswer {
  std::optional<EstimatedRun> estimate;
  std::string reason;
};

/// Traces and times samples of `frame`, each larger than the one before, until the half-widths of frame time
/// and speed-up are at most `tolerance`. Gives up as soon as an exact run is expected to be cheaper: what was
/// traced till then is not lost. `seed` is that of the windows drawn. Neither frame nor machine may be one
/// that not_sampled() refuses.
[[nodiscard]] WithinAnswer estimate_within(SampledFrame& frame,
                                           const processors::machine::PacketList& packets,
                                           const processors::machine::MachineConfig& machine,
                                           double tolerance, std::uint64_t seed = 1);

/// Runs a configuration and gives what to print: an estimate with error bars, or the summary of an exact run
/// and the reason for it; as JSON, an object with `estimate`, or the exact run's result. `exact`: how an
/// exact run is made. Throws UserError as run() does.
[[nodiscard]] std::string run_within(sim::Config& config, double tolerance, bool json, run::RunOptions exact);

/// What scene_summary_of() says, what was left out, and every figure with its error bar.
[[nodiscard]] std::string estimate_text(const run::RunResult& result, const EstimatedRun& run,
                                        double tolerance);
/// The figures as docs/error.md describes them.
[[nodiscard]] std::string estimate_json(const run::RunResult& result, const EstimatedRun& run,
                                        double tolerance);

}  // namespace marti::studies::estimate
