#include "studies/estimate/within.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
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

// A sample of least_windows is taken at once where it traces so little that it costs next to nothing.
constexpr double cheap_share = 0.05;
// The largest share of the pixels that the smallest sample which may do can trace: what is not estimated
// after all is traced once, but the packets of a sample are then replayed in vain.
constexpr double fair_share = 0.2;
// Where a small sample costs more, the lattice is traced first. By the load that it lets expect, a sample of
// least_windows is likely to do where the measured errors leave it so much of what is asked for; else a
// first, smaller sample says what the next must be.
constexpr double likely_share_of_tolerance = 0.5;
constexpr std::uint64_t first_strata = 4;
// The largest share of the pixels that a later sample may trace.
constexpr double most_share = 0.3;
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
    if (std::string reason = begin(); !reason.empty()) {
      return {std::nullopt, std::move(reason)};
    }
    for (;;) {
      WithinAnswer answer = attempt(drawn(strata_));
      if (answer.estimate || !answer.reason.empty()) {
        return answer;
      }
      // The number of strata doubles, so that all that was drawn is drawn again.
      do {
        strata_ *= 2;
      } while (2.0 * static_cast<double>(strata_) < 0.99 * wanted_windows_);
      if (const double share = share_of(strata_); share > most_share) {
        return {std::nullopt,
                fmt::format("a larger sample would trace {:.0f} % of the pixels and replay its packets again",
                            100.0 * share)};
      }
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

  // The share of the pixels that are traced with a sample of so many strata; 1 if that is all windows.
  [[nodiscard]] double share_of(std::uint64_t strata) const {
    const PacketWindows windows = drawn(strata);
    return windows.has_all() ? 1.0 : frame_.share_with(windows);
  }

  static std::string too_large(double share) {
    return fmt::format("the smallest sample would trace {:.0f} % of the pixels and replay its packets first",
                       100.0 * share);
  }

  // Sets the strata of the first sample; or gives the reason why there is none.
  std::string begin() {
    strata_ = least_windows / 2;
    const double share = share_of(strata_);
    if (share > fair_share) {
      return too_large(share);
    }
    if (share <= cheap_share) {
      return "";
    }
    work_.emplace(frame_.with_lattice(), machine_, frame_.lattice(), packets_, visits_);
    const auto& errors = errors_[load_class_of(work_->expected_use(machine_))];
    if (width_of(errors[0].allowance, nodes_) < likely_share_of_tolerance * tolerance_) {
      return "";
    }
    for (const MeasuredError& error : errors) {
      if (width_of(error.allowance, nodes_) < tolerance_) {
        const double needed = share_of(error.windows / 2);
        strata_ = first_strata;
        return needed > fair_share ? too_large(needed) : "";
      }
    }
    return not_known(least_allowance(errors));
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
    const bool small = count < least_windows;
    std::vector<Need> needs = {{Figure::end, sampled.estimate.half_width[Figure::end], sampled.lattice}};
    const auto narrow = [&](const Need& need) {
      return !small && need.half_width + errors[size_class_of(count)].allowance[need.figure] <= tolerance_;
    };
    // One node is timed only where it takes little time, or may be all that is missing.
    if (small || narrow(needs[0])) {
      EstimatedRun run = with_one_node(sampled, log, windows);
      Estimate& machine = run.sampled.machine;
      needs.push_back(
          {Figure::speed_up, machine.half_width[Figure::speed_up], run.sampled.lattice[Figure::speed_up]});
      if (narrow(needs[0]) && (nodes_ == 1 || narrow(needs[1]))) {
        const MeasuredError& error = errors[size_class_of(count)];
        const double one_use = run.sampled.one_node.value[Figure::use];
        widen(machine, error.allowance, nodes_);
        widen(run.sampled.one_node, errors_[load_class_of(one_use)][size_class_of(count)].allowance, 1);
        run.use_to = error.use_to;
        return {run, ""};
      }
      if (nodes_ == 1) {
        needs.pop_back();
      }
    }
    wanted_windows_ = 0.0;
    for (const Need& need : needs) {
      if (std::string reason = enlarge(windows, sampled.degrees, errors, need); !reason.empty()) {
        return {std::nullopt, std::move(reason)};
      }
    }
    return {};
  }

  // What a larger sample is to lessen.
  struct Need {
    Figure figure;
    double half_width;  // the sample's own
    double lattice;     // the lattice's part of it, which stays
  };

  // Raises wanted_windows_ to the fewest windows that are expected to suffice for one figure; else gives the
  // reason why an exact run is cheaper.
  std::string enlarge(const PacketWindows& windows, std::uint64_t degrees,
                      const std::array<MeasuredError, sample_sizes.size()>& errors, const Need& need) {
    const auto all = static_cast<double>(windows.windows());
    const auto now = static_cast<double>(windows.strata().size() * 2);
    double least_error = std::numeric_limits<double>::infinity();
    double wanted = 0.0;
    for (std::size_t size = 0; size < errors.size(); ++size) {
      const double above = size + 1 < errors.size() ? static_cast<double>(sample_sizes[size + 1]) : 2.0 * all;
      const double left = tolerance_ - errors[size].allowance[need.figure];
      if (now < above) {
        least_error = std::min(least_error, tolerance_ - left);
      }
      if (now >= above || left <= need.lattice) {
        continue;
      }
      wanted = std::max(share_for(windows, degrees, need.lattice, need.half_width, left) * all,
                        static_cast<double>(sample_sizes[size]));
      if (wanted < above) {
        break;
      }
    }
    if (wanted == 0.0) {
      return not_known(least_error + need.lattice);
    }
    if (wanted > most_share * all) {
      return fmt::format("a sample that is large enough would trace {:.0f} % of the pixels",
                         std::min(100.0, 100.0 * wanted / all));
    }
    wanted_windows_ = std::max(wanted_windows_, wanted);
    return "";
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
  std::uint64_t strata_ = 0;  // of the next sample
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
