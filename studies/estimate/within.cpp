#include "studies/estimate/within.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/key_error.h"
#include "sim/units.h"
#include "studies/estimate/error_metrics.h"
#include "studies/estimate/measured_errors.h"
#include "studies/estimate/within_output.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/prepared_frame.h"
#include "studies/show/result_json.h"
#include "studies/show/summary.h"

namespace marti::studies::estimate {

namespace {

// A sample of as many windows as the measured errors are known of is taken at once where it traces so little
// that it costs next to nothing.
constexpr double cheap_share = 0.05;
// Else a first, small sample says what the next must be.
constexpr std::uint64_t first_strata = 4;
// The largest share of the pixels that the first sample may trace. If an exact run turns out to be cheaper,
// what was traced is not lost, but its packets were replayed in vain.
constexpr double most_at_first = 0.07;
// The largest share of the pixels that a later sample may trace. Each sample replays the packets of those
// before it again, so that what it traces costs up to twice as much as in an exact run.
constexpr double most_share = 0.5;
// Half-widths of small samples say only roughly what a larger one must be.
constexpr double margin = 1.3;
// Degrees of freedom from which on more of them make an interval hardly narrower.
constexpr std::uint64_t many_degrees = 25;

// The wider of the half-widths that are asked for: those of frame time and speed-up. One node has a speed-up
// of exactly 1.
double width_of(const MachineFigures& half_width, std::uint32_t nodes) {
  return nodes == 1 ? half_width[Figure::end]
                    : std::max(half_width[Figure::end], half_width[Figure::speed_up]);
}

// Adds the measured half-widths to the sample's own.
void widen(Estimate& estimate, const MachineFigures& allowance, std::uint32_t nodes) {
  for (std::size_t i = 0; i < figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    estimate.half_width[figure] += allowance[figure];
  }
  if (nodes == 1) {
    estimate.half_width[Figure::speed_up] = 0.0;  // one node has a speed-up of exactly 1
  }
}

std::string exact_output(const run::RunResult& result, const std::string& reason, bool json) {
  return json
             ? show::json_of(result)
             : show::summary_of(result) + fmt::format("\nmethod        exact replay, no error: {}\n", reason);
}

// The share of all windows whose half-width will be `wanted`, where the windows drawn have `half_width` with
// so many degrees of freedom, and the lattice its part of both. The square of the windows' part goes with 1 /
// share - 1.
double share_for(const PacketWindows& windows, std::uint64_t degrees, double lattice, double half_width,
                 double wanted) {
  if (degrees == 0) {
    return 1.0;
  }
  const double drawn =
      2.0 * static_cast<double>(windows.strata().size()) / static_cast<double>(windows.windows());
  const double student = student_95(std::max(degrees, many_degrees)) / student_95(degrees);
  const double own = margin * student * std::sqrt(std::max(0.0, half_width * half_width - lattice * lattice));
  const double of_windows = std::sqrt(wanted * wanted - lattice * lattice);
  return 1.0 / (1.0 + of_windows / own * (of_windows / own) * (1.0 / drawn - 1.0));
}

// The answer of a sample whose frame time is known well enough.
EstimatedRun with_one_node(const SampledMachine& sampled, const processors::program::WorkLog& log,
                           const processors::machine::MachineConfig& machine, const PacketWindows& windows,
                           const LatticeWork& work) {
  EstimatedRun run;
  run.sampled =
      machine.all_nodes() == 1
          ? add_one_node(sampled, sampled, windows, work)
          : add_one_node(sampled,
                         sample_machine(log, processors::machine::one_node_of(machine), windows, work),
                         windows, work);
  run.windows = windows.strata().size() * 2;
  run.of_windows = windows.windows();
  run.packets = windows.chosen().size();
  run.of_packets = windows.packets().size();
  return run;
}

}  // namespace

double parse_tolerance(std::string_view text) {
  double value = 0.0;
  if (text.ends_with('%')) {
    value = sim::parse_percentage(text);
  } else {
    const std::string hundredfold = std::string(text) + " %";
    try {
      value = 100.0 * sim::parse_percentage(hundredfold);
    } catch (const sim::UserError&) {
      throw sim::UserError("\"" + std::string(text) +
                           "\": a tolerance is a percentage or a fraction, such as \"2 %\" or 0.02");
    }
  }
  if (!(value >= 0.0 && value <= 1.0)) {
    throw sim::UserError("\"" + std::string(text) +
                         "\": a tolerance is from 0 to 100 %, such as \"2 %\" or 0.02");
  }
  return value;
}

std::optional<std::string> not_sampled(const keys::FrameConfig& frame) {
  if (frame.render.voxel_cut > 0.0) {
    return "a frame with the voxel cut is not sampled (image.voxel_cut)";
  }
  if (frame.render.integrator == processors::program::Integrator::path) {
    return "the errors of samples of path-traced frames have not been measured (image.integrator)";
  }
  return std::nullopt;
}

std::optional<std::string> not_sampled(const processors::machine::MachineConfig& machine) {
  try {
    check_sample(machine);
  } catch (const sim::KeyError& error) {
    return error.reason();
  }
  return std::nullopt;
}

WithinAnswer estimate_within(SampledFrame& frame, const processors::machine::PacketList& packets,
                             const processors::machine::MachineConfig& machine, double tolerance,
                             std::uint64_t seed) {
  const std::vector<MeasuredError> errors = parse_measured_errors(measured_errors_csv());
  const auto not_known = [&](double allowance) {
    return fmt::format(
        "samples of such machines are known to have errors of up to {:.2g} % beside what a larger sample "
        "lessens",
        100.0 * allowance);
  };
  const std::uint32_t nodes = machine.all_nodes();
  const auto least = std::min_element(errors.begin(), errors.end(), [&](const auto& a, const auto& b) {
    return width_of(a.allowance, nodes) < width_of(b.allowance, nodes);
  });
  if (width_of(least->allowance, nodes) >= tolerance) {
    return {std::nullopt, not_known(width_of(least->allowance, nodes))};
  }
  std::optional<LatticeWork> work;  // of the lattice, which is traced with the first sample
  const std::uint64_t length = window_length(nodes);
  const std::uint64_t least_strata = *std::min_element(least_windows.begin(), least_windows.end()) / 2;
  const bool cheap = frame.share_with({packets, length, least_strata, seed}) <= cheap_share;
  const std::uint64_t begun = cheap ? least_strata : first_strata;
  double most = most_at_first;
  for (std::uint64_t strata = begun;;) {
    const PacketWindows windows(packets, length, strata, seed);
    if (const double share = frame.share_with(windows); windows.has_all() || share > most) {
      return {std::nullopt,
              fmt::format("{} would trace {:.0f} % of the pixels and replay its packets {}",
                          strata == begun ? "the smallest sample" : "a larger sample",
                          100.0 * (windows.has_all() ? 1.0 : share), strata == begun ? "first" : "again")};
    }
    most = most_share;
    const processors::program::WorkLog& log = frame.with(windows);
    if (!work) {
      work.emplace(log, machine, frame.lattice(), packets);
    }
    const SampledMachine sampled = sample_machine(log, machine, windows, *work);
    const std::size_t load = load_class_of(sampled.estimate.value[Figure::use]);
    const MachineFigures& allowance = errors[load].allowance;
    const std::uint64_t drawn = windows.strata().size() * 2;
    const auto of_windows = static_cast<double>(windows.windows());
    double share = 2.0 * static_cast<double>(drawn) / of_windows;
    share = std::max(share, static_cast<double>(least_windows[load]) / of_windows);
    // Gives the reason when no sample is large enough.
    const auto enlarge = [&](Figure figure, const Estimate& estimate, double lattice) {
      const double wanted = tolerance - allowance[figure];
      share = std::max(share, wanted > lattice ? share_for(windows, sampled.degrees, lattice,
                                                           estimate.half_width[figure], wanted)
                                               : 1.0);
      return wanted > lattice ? "" : not_known(allowance[figure] + lattice);
    };
    std::string reason;
    if (sampled.estimate.half_width[Figure::end] + allowance[Figure::end] > tolerance) {
      reason = enlarge(Figure::end, sampled.estimate, sampled.lattice);
    } else if (drawn >= least_windows[load]) {
      // One node is timed only now: most samples that are too small are found out before.
      EstimatedRun run = with_one_node(sampled, log, machine, windows, *work);
      const Estimate own = run.sampled.machine;
      widen(run.sampled.machine, allowance, nodes);
      widen(run.sampled.one_node, errors[load_class_of(run.sampled.one_node.value[Figure::use])].allowance,
            1);
      if (nodes == 1 || run.sampled.machine.half_width[Figure::speed_up] <= tolerance) {
        run.use_to = errors[load].use_to;
        return {run, ""};
      }
      reason = enlarge(Figure::speed_up, own, run.sampled.lattice[Figure::speed_up]);
    }
    if (!reason.empty()) {
      return {std::nullopt, reason};
    }
    if (share > most_share) {
      return {std::nullopt,
              fmt::format("a sample that is large enough would trace {:.0f} % of the pixels", 100.0 * share)};
    }
    // The number of strata doubles, so that all that was drawn is drawn again.
    for (double next = static_cast<double>(drawn) / of_windows; next < 0.99 * share; next *= 2.0) {
      strata *= 2;
    }
  }
}

std::string run_within(sim::Config& config, double tolerance, bool json, run::RunOptions exact) {
  keys::FrameConfig frame = keys::read_frame(config);
  frame.meter = exact.meter;
  run::refuse_several_frames(config, frame.frames);
  const processors::machine::MachineConfig machine = keys::read_machine(config);
  const keys::RecordConfig record = keys::read_record(config, true);
  if (record.heat_maps || record.timeline || record.critical_path) {
    config.fail(record.timeline    ? "record.timeline"
                : record.heat_maps ? "record.heat_maps"
                                   : "record.critical_path",
                "an estimate does nothing that could be recorded; leave --within out");
  }
  config.refuse_unused();
  run::refuse_beyond_memory(config, frame, machine);
  std::optional<std::string> reason = not_sampled(frame);
  if (!reason) {
    reason = not_sampled(machine);
  }
  if (tolerance == 0.0) {
    reason = "nothing else is within 0 %";
  }
  if (reason) {
    return exact_output(run::run(config, std::move(exact)), *reason, json);
  }
  return sim::with_places(config, [&] {
    const run::PreparedFrame prepared(frame);
    SampledFrame sampled = sampled_frame(prepared);
    const processors::machine::PacketList packets(frame.render.width, frame.render.height, machine.packets);
    const WithinAnswer answer = estimate_within(sampled, packets, machine, tolerance);
    if (!answer.estimate) {
      exact.functional = prepared.finish(std::move(sampled).whole());
      return exact_output(run::run(config, std::move(exact)), answer.reason, json);
    }
    run::RunResult result;
    result.config_name = config.name();
    result.values = config.effective_values();
    result.frame_config = frame;
    result.machine = machine;
    const TracedPart traced = sampled.traced();
    result.functional = prepared.part(sampled.part());
    return json ? estimate_json(result, *answer.estimate, traced, tolerance)
                : estimate_text(result, *answer.estimate, traced, tolerance);
  });
}

}  // namespace marti::studies::estimate
