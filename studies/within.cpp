#include "studies/within.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "accel/octree.h"
#include "processors/packets.h"
#include "sim/error.h"
#include "sim/units.h"
#include "studies/error/measured_errors.h"
#include "studies/error/simulator_analytic.h"
#include "studies/error/simulator_errors.h"
#include "studies/error/simulator_methods.h"
#include "studies/machine_keys.h"
#include "studies/record_keys.h"
#include "studies/run_result.h"
#include "studies/text_units.h"

namespace marti::studies {

namespace {

// The study's frames have so many packets, and so many for each of its nodes, at least.
constexpr std::uint64_t least_packets = 1024;
constexpr std::uint64_t least_packets_a_node = 4;
constexpr std::uint64_t sample_seed = 1;
// A method whose intervals hold less often on scenes that they were not measured on is not taken.
constexpr double least_covered = 0.9;
// Mean values take misses to come one by one. They come in bursts, whose queues on a busier bus depend on the
// frame more than the study's small frames show (docs/error.md).
constexpr double most_analytic_use = 0.25;

// Both half-widths together. That of the interconnect's use is measured in points, on machines that may use
// it less; it is at least what the misses and the frame time leave open, which are relative.
void widen(Estimate& estimate, const MeasuredError& measured, std::uint32_t nodes) {
  Figures& half = estimate.half_width;
  for (std::size_t i = 0; i < figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    half[figure] += measured.allowance[figure];
  }
  half[Figure::use] =
      std::max(half[Figure::use], estimate.value[Figure::use] * (half[Figure::misses] + half[Figure::end]));
  if (nodes == 1) {
    half[Figure::speed_up] = 0.0;  // a node is as fast as itself, whatever a method says
  }
}

double width_of(const Figures& half_width) {
  return std::max(half_width[Figure::end], half_width[Figure::speed_up]);
}

// The measured errors of a method for a number of nodes; null when there are none.
const MeasuredError* find(const std::vector<MeasuredError>& errors, std::size_t method, std::uint32_t nodes) {
  const std::optional<std::size_t> node_class = node_class_of(nodes);
  const auto found = std::find_if(errors.begin(), errors.end(), [&](const MeasuredError& error) {
    return node_class && error.method == method && error.nodes_to == node_classes[*node_class];
  });
  return found == errors.end() ? nullptr : &*found;
}

std::string bar(std::string value, double half_width, std::string low, std::string high) {
  return std::isfinite(half_width) ? fmt::format("{:<14}+- {:<8} {} to {}\n", value,
                                                 fmt::format("{:.2g} %", 100.0 * half_width), low, high)
                                   : fmt::format("{:<14}error not known\n", value);
}

std::string time_bar(double ticks, double half_width) {
  const auto text = [](double value) { return seconds(std::llround(value)); };
  return bar(text(ticks), half_width, text(ticks / (1.0 + half_width)),
             half_width < 1.0 ? text(ticks / (1.0 - half_width)) : "any time");
}

std::string number_bar(double value, double half_width, int digits) {
  const auto text = [digits](double number) { return fmt::format("{:.{}f}", number, digits); };
  return bar(text(value), half_width, text(value / (1.0 + half_width)),
             half_width < 1.0 ? text(value / (1.0 - half_width)) : "any number");
}

// A figure in percent, with its half-width in points.
std::string points_bar(double percent, double half_width, std::string_view what) {
  const std::string value = fmt::format("{:.2f} %{}", percent, what);
  return std::isfinite(half_width) ? fmt::format("{:<14}+- {:.2g} points\n", value, half_width)
                                   : fmt::format("{:<14}error not known\n", value);
}

std::string text_of(const EstimatedRun& run, double tolerance, std::uint32_t nodes) {
  const Method& method = simulator_methods()[run.method];
  const Figures& value = run.machine.value;
  const Figures& half = run.machine.half_width;
  const double share =
      run.machine.references > 0.0 ? 100.0 * value[Figure::misses] / run.machine.references : 0.0;
  std::string text = fmt::format(
      "\nestimate      {}, {}: not exact, asked for within {:g} %\n"
      "rests on      errors that `marti study error` measured against exact replay on machines of up to {} "
      "nodes with the bus and the banks of configs/error.toml, of which 95 % are covered{}\n\n",
      method.name(), method.knob(), 100.0 * tolerance, run.nodes_to,
      method.kind == MethodKind::sampled ? ", and the spread of this run's own sample" : "");
  text += "frame time    " + time_bar(value[Figure::end], half[Figure::end]);
  text += fmt::format("speed-up      {}", number_bar(value[Figure::speed_up], half[Figure::speed_up], 2));
  text += fmt::format("  on {} node{}\n", nodes, nodes == 1 ? "" : "s");
  text += "one node      " + time_bar(run.one_node.value[Figure::end], run.one_node.half_width[Figure::end]);
  text += "misses        " + number_bar(value[Figure::misses], half[Figure::misses], 0);
  text += "hit ratio     " + points_bar(100.0 - share, share * half[Figure::misses], "");
  text += "interconnect  " + points_bar(100.0 * value[Figure::use], 100.0 * half[Figure::use], " busy");
  text += "mean wait     " + time_bar(value[Figure::wait], half[Figure::wait]);
  text += "\nall else is told by exact replay: run without --within\n";
  return text;
}

std::string exact_text(const RunResult& result, const std::string& reason) {
  return summary_of(result) + fmt::format("\nmethod        exact replay, no error: {}\n", reason);
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

std::optional<std::string> outside_measured(const FrameConfig& frame) {
  if (frame.structure != accel::Octree::kind_name || frame.render.mailboxes) {
    return "errors have been measured with an octree without mailboxes only";
  }
  if (frame.render.samples > 1 || frame.render.voxel_cut > 0.0) {
    return "errors have been measured with one sample a pixel and without the voxel cut only";
  }
  return std::nullopt;
}

std::optional<std::string> outside_measured(const processors::MachineConfig& machine, std::uint64_t packets) {
  try {
    check_analytic(machine);
  } catch (const sim::UserError& error) {
    return error.what();
  }
  if (machine.interconnect.kind != memory::InterconnectKind::bus ||
      machine.interconnect.mode != memory::BusMode::split) {
    return "errors have been measured with a split bus only";
  }
  if (!node_class_of(machine.nodes)) {
    return fmt::format("errors have been measured with up to {} nodes only", node_classes.back());
  }
  if (packets < std::max(least_packets, least_packets_a_node * machine.nodes)) {
    return fmt::format("errors have been measured with at least {} packets, and {} for each node, only",
                       least_packets, least_packets_a_node);
  }
  return std::nullopt;
}

std::optional<EstimatedRun> estimate_within(const processors::WorkLog& log,
                                            const processors::MachineConfig& machine, double tolerance) {
  const std::vector<MeasuredError> errors = parse_measured_errors(measured_errors_csv());
  std::vector<const MeasuredError*> candidates;
  const MeasuredError* const exact = find(errors, 0, machine.nodes);
  for (std::size_t method = 1; exact != nullptr && method < simulator_methods().size(); ++method) {
    const MeasuredError* const error = find(errors, method, machine.nodes);
    // One that is no faster than exact replay is never better; one that is wider than asked for in what was
    // measured alone never fits.
    if (error != nullptr && error->covered >= least_covered && error->share < exact->share &&
        width_of(error->allowance) <= tolerance && find(errors, method, 1) != nullptr) {
      candidates.push_back(error);
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto* a, const auto* b) { return a->share < b->share; });
  for (const MeasuredError* const candidate : candidates) {
    const Method& method = simulator_methods()[candidate->method];
    // A sample that is expected to be too small is not tried.
    if (width_of(candidate->allowance) + width_of(candidate->own) > tolerance) {
      continue;
    }
    EstimatedRun run;
    run.method = candidate->method;
    run.nodes_to = candidate->nodes_to;
    run.machine = estimate(method, log, machine, sample_seed);
    run.one_node = machine.nodes == 1 ? run.machine
                                      : estimate(method, log, processors::one_node_of(machine), sample_seed);
    if (method.kind == MethodKind::analytic && run.machine.value[Figure::use] > most_analytic_use) {
      continue;
    }
    add_speed_up(run.machine, run.one_node);
    widen(run.machine, *candidate, machine.nodes);
    widen(run.one_node, *find(errors, candidate->method, 1), 1);
    if (width_of(run.machine.half_width) <= tolerance) {
      return run;
    }
  }
  return std::nullopt;
}

std::string run_within(sim::Config& config, double tolerance) {
  FrameConfig frame = read_frame(config);
  refuse_several_frames(config, frame.frames);
  const processors::MachineConfig machine = read_machine(config);
  const RecordConfig record = read_record(config, true);
  if (record.heat_maps || record.timeline) {
    config.fail(record.timeline ? "record.timeline" : "record.heat_maps",
                "an estimate does nothing that could be recorded; leave --within out");
  }
  config.refuse_unused();
  refuse_beyond_memory(config, frame, machine);
  const std::uint64_t packets =
      processors::PacketList(frame.render.width, frame.render.height, machine.packets).size();
  std::optional<std::string> reason = outside_measured(frame);
  if (!reason) {
    reason = outside_measured(machine, packets);
  }
  if (tolerance == 0.0) {
    reason = "nothing else is within 0 %";
  }
  if (reason) {
    return exact_text(run(config), *reason);
  }
  RunResult result;
  result.frame_config = frame;
  result.functional = run_functional(frame);
  const std::optional<EstimatedRun> estimated =
      estimate_within(*result.functional.frame.log, machine, tolerance);
  if (!estimated) {
    return exact_text(
        run(config, {}, {}, std::move(result.functional)),
        fmt::format("no cheaper method has been measured to be within {:g} % here", 100.0 * tolerance));
  }
  return scene_summary_of(result) + text_of(*estimated, tolerance, machine.nodes);
}

}  // namespace marti::studies
