#include "studies/estimate/within.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "accel/octree.h"
#include "processors/machine/packets.h"
#include "sim/config_errors.h"
#include "sim/error.h"
#include "sim/units.h"
#include "studies/estimate/measured_errors.h"
#include "studies/estimate/simulator_analytic.h"
#include "studies/estimate/simulator_methods.h"
#include "studies/estimate/within_output.h"
#include "studies/keys/machine_keys.h"
#include "studies/keys/record_keys.h"
#include "studies/run/run_result.h"

namespace marti::studies {

namespace {

// The study's frames have at least so many packets, and at least so many for each node.
constexpr std::uint64_t least_packets = 1024;
constexpr std::uint64_t least_packets_a_node = 4;
constexpr std::uint64_t sample_seed = 1;
// The least share of a method's intervals that must hold on scenes that they were not measured on.
constexpr double least_covered = 0.9;
// Mean values assume that misses come one by one. They come in bursts, and on a busier bus the queues of
// these depend on the frame more than the study's small frames show (docs/error.md).
constexpr double most_analytic_use = 0.25;

// Adds the measured half-widths to the method's own. That of the interconnect's use was measured in
// percentage points, on machines that may use it less; it is at least the use times the relative half-widths
// of misses and frame time.
void widen(Estimate& estimate, const MeasuredError& measured, std::uint32_t nodes) {
  MachineFigures& half = estimate.half_width;
  for (std::size_t i = 0; i < figure_count; ++i) {
    const auto figure = static_cast<Figure>(i);
    half[figure] += measured.allowance[figure];
  }
  half[Figure::use] =
      std::max(half[Figure::use], estimate.value[Figure::use] * (half[Figure::misses] + half[Figure::end]));
  if (nodes == 1) {
    half[Figure::speed_up] = 0.0;  // one node has a speed-up of exactly 1
  }
}

double width_of(const MachineFigures& half_width) {
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

std::string exact_output(const RunResult& result, const std::string& reason, bool json) {
  return json ? json_of(result)
              : summary_of(result) + fmt::format("\nmethod        exact replay, no error: {}\n", reason);
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
  } catch (const sim::KeyError& error) {
    return error.reason();
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
    // A method that is not faster than exact replay is useless; one whose measured half-width alone exceeds
    // the tolerance never fits.
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

std::string run_within(sim::Config& config, double tolerance, bool json, RunOptions exact) {
  FrameConfig frame = read_frame(config);
  refuse_several_frames(config, frame.frames);
  const processors::MachineConfig machine = read_machine(config);
  const RecordConfig record = read_record(config, true);
  if (record.heat_maps || record.timeline || record.critical_path) {
    config.fail(record.timeline    ? "record.timeline"
                : record.heat_maps ? "record.heat_maps"
                                   : "record.critical_path",
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
    return exact_output(run(config, std::move(exact)), *reason, json);
  }
  RunResult result;
  result.config_name = config.name();
  result.values = config.effective_values();
  result.frame_config = frame;
  result.machine = machine;
  result.functional = sim::with_places(config, [&] { return run_functional(frame); });
  const std::optional<EstimatedRun> estimated =
      estimate_within(*result.functional.frame.log, machine, tolerance);
  if (!estimated) {
    exact.functional = std::move(result.functional);
    return exact_output(
        run(config, std::move(exact)),
        fmt::format("no cheaper method has been measured to be within {:g} % here", 100.0 * tolerance), json);
  }
  return json ? estimate_json(result, *estimated, tolerance) : estimate_text(result, *estimated, tolerance);
}

}  // namespace marti::studies
