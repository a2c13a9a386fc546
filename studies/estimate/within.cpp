#include "studies/estimate/within.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

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
// Or where it traces so little, and the lattice says that it is likely to be large enough.
constexpr double fair_share = 0.15;
// Else a first, small sample says what the next must be.
constexpr std::uint64_t first_strata = 4;
// The largest share of the pixels that this first sample may trace. If an exact run turns out to be cheaper,
// what was traced is not lost, but its packets were replayed in vain.
constexpr double most_at_first = 0.07;
// The largest share of the pixels that a later sample may trace. Each sample replays the packets of those
// before it again, so that what it traces costs up to twice as much as in an exact run.
constexpr double most_share = 0.5;
// A sample of least_windows is taken to be large enough where the measured errors leave it so much of what is
// asked for.
constexpr double likely_share_of_tolerance = 0.5;
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
  // By one standard error of a standard deviation from so many degrees of freedom.
  const double margin = 1.0 + 1.0 / std::sqrt(2.0 * static_cast<double>(degrees));
  const double own = margin * student * std::sqrt(std::max(0.0, half_width * half_width - lattice * lattice));
  const double of_windows = std::sqrt(wanted * wanted - lattice * lattice);
  return 1.0 / (1.0 + of_windows / own * (of_windows / own) * (1.0 / drawn - 1.0));
}

// A frame whose samples grow until one is large enough.
class Sampling {
 public:
  Sampling(SampledFrame& frame, const processors::machine::PacketList& packets,
           const processors::machine::MachineConfig& machine, double tolerance, std::uint64_t seed)
      : frame_(frame),
        packets_(packets),
        machine_(machine),
        nodes_(machine.all_nodes()),
        tolerance_(tolerance),
        seed_(seed),
        errors_(parse_measured_errors(measured_errors_csv())) {}

  WithinAnswer answer() {
    double least = least_allowance(errors_[0]);
    for (const auto& load : errors_) {
      least = std::min(least, least_allowance(load));
    }
    if (least >= tolerance_) {
      return {std::nullopt, not_known(least)};
    }
    std::uint64_t strata = first();
    double most = 2 * strata >= least_windows ? fair_share : most_at_first;
    for (bool begun = false;; begun = true, most = most_share) {
      const PacketWindows windows = drawn(strata);
      if (const double share = frame_.share_with(windows); windows.has_all() || share > most) {
        return {std::nullopt,
                fmt::format("{} would trace {:.0f} % of the pixels and replay its packets {}",
                            begun ? "a larger sample" : "the smallest sample",
                            100.0 * (windows.has_all() ? 1.0 : share), begun ? "again" : "first")};
      }
      WithinAnswer answer = attempt(windows);
      if (answer.estimate || !answer.reason.empty()) {
        return answer;
      }
      // The number of strata doubles, so that all that was drawn is drawn again.
      do {
        strata *= 2;
      } while (2.0 * static_cast<double>(strata) < 0.99 * wanted_windows_);
    }
  }

 private:
  [[nodiscard]] PacketWindows drawn(std::uint64_t strata) const {
    return {packets_, window_length(nodes_), strata, seed_};
  }

  [[nodiscard]] double least_allowance(const std::array<MeasuredError, sample_sizes.size()>& load) const {
    double least = width_of(load[0].allowance, nodes_);
    for (const MeasuredError& error : load) {
      least = std::min(least, width_of(error.allowance, nodes_));
    }
    return least;
  }

  [[nodiscard]] static std::string not_known(double allowance) {
    return fmt::format(
        "samples of such machines are known to have errors of up to {:.2g} % beside what a larger sample "
        "lessens",
        100.0 * allowance);
  }

  // The strata of the first sample.
  std::uint64_t first() {
    constexpr std::uint64_t least_strata = least_windows / 2;
    const double share = frame_.share_with(drawn(least_strata));
    if (share > cheap_share && share <= fair_share) {
      work_.emplace(frame_.with_lattice(), machine_, frame_.lattice(), packets_, visits_);
      const MeasuredError& error = errors_[load_class_of(work_->expected_use(machine_))][0];
      return width_of(error.allowance, nodes_) < likely_share_of_tolerance * tolerance_ ? least_strata
                                                                                        : first_strata;
    }
    return share <= cheap_share ? least_strata : first_strata;
  }

  // An estimate; or the reason why there is none; or neither, and wanted_windows_.
  WithinAnswer attempt(const PacketWindows& windows) {
    const processors::program::WorkLog& log = frame_.with(windows);
    if (!work_) {
      work_.emplace(log, machine_, frame_.lattice(), packets_, visits_);
    }
    const SampledMachine sampled = sample_machine(log, machine_, windows, *work_, visits_);
    const auto& errors = errors_[load_class_of(sampled.estimate.value[Figure::use])];
    const std::uint64_t count = windows.strata().size() * 2;
    if (count < least_windows) {
      return enlarge(windows, sampled.degrees, errors, Figure::end, sampled.estimate, sampled.lattice);
    }
    const MeasuredError& error = errors[size_class_of(count)];
    if (sampled.estimate.half_width[Figure::end] + error.allowance[Figure::end] > tolerance_) {
      return enlarge(windows, sampled.degrees, errors, Figure::end, sampled.estimate, sampled.lattice);
    }
    // One node is timed only now: most samples that are too small are found out before.
    EstimatedRun run = with_one_node(sampled, log, windows);
    const Estimate own = run.sampled.machine;
    widen(run.sampled.machine, error.allowance, nodes_);
    const double one_use = run.sampled.one_node.value[Figure::use];
    widen(run.sampled.one_node, errors_[load_class_of(one_use)][size_class_of(count)].allowance, 1);
    if (nodes_ == 1 || run.sampled.machine.half_width[Figure::speed_up] <= tolerance_) {
      run.use_to = error.use_to;
      return {run, ""};
    }
    return enlarge(windows, sampled.degrees, errors, Figure::speed_up, own,
                   run.sampled.lattice[Figure::speed_up]);
  }

  // Sets wanted_windows_ to the fewest windows that are expected to suffice; else gives the
  // reason why an exact run is cheaper.
  WithinAnswer enlarge(const PacketWindows& windows, std::uint64_t degrees,
                       const std::array<MeasuredError, sample_sizes.size()>& errors, Figure figure,
                       const Estimate& estimate, double lattice) {
    const auto all = static_cast<double>(windows.windows());
    const auto now = static_cast<double>(windows.strata().size() * 2);
    double least_error = std::numeric_limits<double>::infinity();
    bool known = false;
    for (std::size_t size = 0; size < errors.size(); ++size) {
      if (size + 1 < errors.size() && now >= static_cast<double>(sample_sizes[size + 1])) {
        continue;
      }
      const double allowance = errors[size].allowance[figure];
      least_error = std::min(least_error, allowance);
      if (tolerance_ - allowance <= lattice) {
        continue;
      }
      known = true;
      const double share =
          share_for(windows, degrees, lattice, estimate.half_width[figure], tolerance_ - allowance);
      wanted_windows_ = std::max(share * all, static_cast<double>(sample_sizes[size]));
      if (size + 1 == errors.size() || wanted_windows_ < static_cast<double>(sample_sizes[size + 1])) {
        break;
      }
    }
    if (!known) {
      return {std::nullopt, not_known(least_error + lattice)};
    }
    if (wanted_windows_ > most_share * all) {
      return {std::nullopt, fmt::format("a sample that is large enough would trace {:.0f} % of the pixels",
                                        std::min(100.0, 100.0 * wanted_windows_ / all))};
    }
    return {};
  }

  // The answer of a sample whose frame time is known well enough.
  EstimatedRun with_one_node(const SampledMachine& sampled, const processors::program::WorkLog& log,
                             const PacketWindows& windows) {
    EstimatedRun run;
    run.sampled = nodes_ == 1 ? add_one_node(sampled, sampled, windows, *work_)
                              : add_one_node(sampled,
                                             sample_machine(log, processors::machine::one_node_of(machine_),
                                                            windows, *work_, visits_),
                                             windows, *work_);
    run.windows = windows.strata().size() * 2;
    run.of_windows = windows.windows();
    run.packets = windows.chosen().size();
    run.of_packets = windows.packets().size();
    return run;
  }

  SampledFrame& frame_;
  const processors::machine::PacketList& packets_;
  const processors::machine::MachineConfig& machine_;
  std::uint32_t nodes_;
  double tolerance_;
  std::uint64_t seed_;
  MeasuredErrors errors_;
  std::optional<LatticeWork> work_;  // empty before the lattice is traced
  processors::walk::KeptVisits visits_;
  double wanted_windows_ = 0.0;
};

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
  return Sampling(frame, packets, machine, tolerance, seed).answer();
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
    result.functional = prepared.part(std::move(sampled).part());
    return json ? estimate_json(result, *answer.estimate, traced, tolerance)
                : estimate_text(result, *answer.estimate, traced, tolerance);
  });
}

}  // namespace marti::studies::estimate
