#include "studies/estimate/within.h"

#include <fmt/format.h>

#include <algorithm>
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
// Of smaller packets a node's cache holds what several of them share, and a sample begins each window without
// it: the frame takes up to a tenth less time than a sample says, with a cache that holds most of what a
// window reads.
constexpr std::uint64_t least_packet_pixels = 64;
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
  // Widened by one standard error of a standard deviation with so many degrees of freedom.
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
    double least = std::numeric_limits<double>::infinity();
    for (const ErrorsBySize& load : errors_) {
      least = std::min(least, least_allowance(load));
    }
    if (least >= tolerance_) {
      return {std::nullopt, not_known(least)};
    }
    if (std::string reason = begin(); !reason.empty()) {
      return {std::nullopt, std::move(reason)};
    }
    for (;;) {
      const PacketWindows windows = drawn(strata_);
      const Attempt attempt = attempted(windows);
      if (attempt.run) {
        return {attempt.run, ""};
      }
      double wanted = 0.0;
      for (const Need& need : attempt.needs) {
        const Enlarged enlarged = enlarge(windows, attempt, need);
        if (!enlarged.refusal.empty()) {
          return {std::nullopt, enlarged.refusal};
        }
        wanted = std::max(wanted, enlarged.windows);
      }
      // The number of strata doubles, so that all that was drawn is drawn again.
      do {
        strata_ *= 2;
      } while (2.0 * static_cast<double>(strata_) < 0.99 * wanted);
      if (const double share = share_of(strata_); share > most_share) {
        return {std::nullopt,
                fmt::format("a larger sample would trace {:.0f} % of the pixels and replay its packets again",
                            100.0 * share)};
      }
    }
  }

 private:
  // A figure that a sample does not say narrowly enough, or whose width is not known yet.
  struct Need {
    Figure figure;
    double half_width;  // the sample's own
    double lattice;     // the lattice's part of it, which stays
  };
  // What one sample has given: the answer, or what a larger sample is to lessen.
  struct Attempt {
    std::optional<EstimatedRun> run{};
    std::vector<Need> needs{};
    std::size_t load = 0;       // class
    std::uint64_t degrees = 0;  // of freedom
  };
  // The fewest windows that are expected to suffice; or why an exact run is cheaper.
  struct Enlarged {
    double windows = 0.0;
    std::string refusal{};
  };

  [[nodiscard]] PacketWindows drawn(std::uint64_t strata) const {
    return {packets_, window_length(nodes_), strata, seed_};
  }

  [[nodiscard]] double least_allowance(const ErrorsBySize& load) const {
    double least = std::numeric_limits<double>::infinity();
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

  // Sets strata_ for the first sample and returns an empty text. If an exact run is cheaper than any sample,
  // returns the reason.
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
    const ErrorsBySize& errors = errors_[load_class_of(work_->expected_use(machine_))];
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

  // Traces and times a sample.
  Attempt attempted(const PacketWindows& windows) {
    const processors::program::WorkLog& log = frame_.with(windows);
    if (!work_) {
      work_.emplace(log, machine_, frame_.lattice(), packets_, visits_);
    }
    const SampledMachine sampled = sample_machine(log, machine_, windows, *work_, visits_);
    Attempt attempt;
    attempt.load = load_class_of(sampled.estimate.value[Figure::use]);
    attempt.degrees = sampled.degrees;
    attempt.needs = {{Figure::end, sampled.estimate.half_width[Figure::end], sampled.lattice}};
    const std::uint64_t count = windows.strata().size() * 2;
    const MeasuredError* const error =
        count < least_windows ? nullptr : &errors_[attempt.load][size_class_of(count)];
    const auto narrow = [&](const Need& need) {
      return error != nullptr && need.half_width + error->allowance[need.figure] <= tolerance_;
    };
    const bool end_narrow = narrow(attempt.needs[0]);
    // One node is timed only where it takes little time, or may be all that is missing.
    if (error != nullptr && !end_narrow) {
      return attempt;
    }
    EstimatedRun run = with_one_node(sampled, log, windows);
    Estimate& machine = run.sampled.machine;
    if (nodes_ > 1) {
      attempt.needs.push_back(
          {Figure::speed_up, machine.half_width[Figure::speed_up], run.sampled.lattice[Figure::speed_up]});
    }
    if (end_narrow && narrow(attempt.needs.back())) {
      const std::size_t one_load = load_class_of(run.sampled.one_node.value[Figure::use]);
      widen(machine, error->allowance, nodes_);
      widen(run.sampled.one_node, errors_[one_load][size_class_of(count)].allowance, 1);
      run.use_to = error->use_to;
      attempt.run = run;
    }
    return attempt;
  }

  [[nodiscard]] Enlarged enlarge(const PacketWindows& windows, const Attempt& attempt,
                                 const Need& need) const {
    const ErrorsBySize& errors = errors_[attempt.load];
    const auto all = static_cast<double>(windows.windows());
    const std::uint64_t now = windows.strata().size() * 2;
    double least_error = std::numeric_limits<double>::infinity();
    double wanted = 0.0;
    for (std::size_t size = size_class_of(std::max(now, least_windows)); size < errors.size(); ++size) {
      const double allowance = errors[size].allowance[need.figure];
      least_error = std::min(least_error, allowance);
      if (tolerance_ - allowance <= need.lattice) {
        continue;
      }
      wanted = std::max(
          share_for(windows, attempt.degrees, need.lattice, need.half_width, tolerance_ - allowance) * all,
          static_cast<double>(sample_sizes[size]));
      if (size + 1 < errors.size() && wanted < static_cast<double>(sample_sizes[size + 1])) {
        break;
      }
    }
    if (wanted == 0.0) {
      return {0.0, not_known(least_error + need.lattice)};
    }
    if (wanted > most_share * all) {
      return {0.0, fmt::format("a sample that is large enough would trace {:.0f} % of the pixels",
                               std::min(100.0, 100.0 * wanted / all))};
    }
    return {wanted, ""};
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
  if (std::uint64_t{machine.packets.width} * machine.packets.height < least_packet_pixels) {
    return fmt::format(
        "the errors of samples have been measured for packets of {} pixels or more, and these have {} x {}",
        least_packet_pixels, machine.packets.width, machine.packets.height);
  }
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
