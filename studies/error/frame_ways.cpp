// The ways to a machine's frame time.
#include <fmt/format.h>

#include <algorithm>

#include "processors/replay/bounds.h"
#include "processors/replay/replay.h"
#include "studies/error/setting.h"
#include "studies/estimate/within.h"
#include "studies/run/prepared_frame.h"
#include "studies/tables/text_units.h"

namespace marti::studies::error {

namespace {

using processors::machine::MachineConfig;
using processors::program::WorkLog;

// The frame time of the machine; that of one node, which a speed-up needs, is found beside it.
double frame_time_of(const WorkLog& log, const MachineConfig& machine) {
  if (machine.all_nodes() > 1) {
    (void)processors::replay::replay(log, processors::machine::one_node_of(machine));
  }
  return static_cast<double>(processors::replay::replay(log, machine).end);
}

double traced_time(const keys::FrameConfig& frame, const MachineConfig& machine) {
  return frame_time_of(*run::PreparedFrame(frame).trace().log, machine);
}

// No frame ends before its nodes have done their work, however evenly it is shared out, nor before what all
// nodes share has done its own. Both are taken from a run of one node.
double bound_of(const keys::FrameConfig& frame, const MachineConfig& machine) {
  const processors::program::Frame traced = run::PreparedFrame(frame).trace();
  const MachineConfig one = processors::machine::one_node_of(machine);
  const processors::replay::FrameBounds bounds =
      processors::replay::frame_bounds(one, processors::replay::replay(*traced.log, one));
  return std::max({static_cast<double>(bounds.node_work) / machine.all_nodes(),
                   static_cast<double>(bounds.interconnect) / machine.clusters,
                   static_cast<double>(bounds.bank) / machine.clusters});
}

Answer answer_within(const keys::FrameConfig& frame, const MachineConfig& machine, double tolerance) {
  std::optional<std::string> reason = estimate::not_sampled(frame);
  if (!reason) {
    reason = estimate::not_sampled(machine);
  }
  if (reason) {
    return {traced_time(frame, machine), {}, "exact: " + *reason};
  }
  const run::PreparedFrame prepared(frame);
  estimate::SampledFrame sampled = estimate::sampled_frame(prepared);
  const processors::machine::PacketList packets(frame.render.width, frame.render.height, machine.packets);
  const estimate::WithinAnswer answer = estimate::estimate_within(sampled, packets, machine, tolerance);
  if (!answer.estimate) {
    return {frame_time_of(*std::move(sampled).whole().log, machine), {}, "exact: " + answer.reason};
  }
  const estimate::Estimate& found = answer.estimate->sampled.machine;
  return {found.value[estimate::Figure::end],
          {},
          fmt::format("its own error bar: +- {:.2g} %", 100.0 * found.half_width[estimate::Figure::end])};
}

}  // namespace

void add_frame_ways(const ErrorConfig& config, std::vector<Setting>& settings) {
  const std::size_t exact = settings.size();
  const auto add = [&](std::string way, std::string name, double value, std::function<Answer()> run) {
    Setting& setting = settings.emplace_back();
    setting.asked = frame_time;
    setting.way = std::move(way);
    setting.name = std::move(name);
    setting.value = value;
    setting.exact = exact;
    setting.run = [run = std::move(run)](std::uint32_t) { return run(); };
  };
  const keys::FrameConfig& frame = config.frame;
  const MachineConfig& machine = config.machine;
  add("exact run", "-", 0.0, [&] { return Answer{traced_time(frame, machine), {}, ""}; });
  for (const double tolerance : config.within) {
    add("--within", fmt::format("{:g} %", 100.0 * tolerance), tolerance,
        [&, tolerance] { return answer_within(frame, machine, tolerance); });
  }
  for (const std::uint32_t divisor : config.divisors) {
    keys::FrameConfig smaller = frame;
    smaller.render = keys::made_small(
        frame.render, std::max(frame.render.width, frame.render.height) / static_cast<double>(divisor));
    const double pixels = static_cast<double>(frame.render.width) * frame.render.height /
                          (static_cast<double>(smaller.render.width) * smaller.render.height);
    add("smaller image", fmt::format("{} x {}", smaller.render.width, smaller.render.height), divisor,
        [&, smaller, pixels] {
          return Answer{pixels * traced_time(smaller, machine), {}, ""};
        });
  }
  for (const std::uint32_t samples : config.samples) {
    if (samples < frame.render.samples) {
      keys::FrameConfig fewer = frame;
      fewer.render.samples = samples;
      const double times = static_cast<double>(frame.render.samples) / samples;
      add("fewer samples", tables::counted(samples, "sample"), samples, [&, fewer, times] {
        return Answer{times * traced_time(fewer, machine), {}, ""};
      });
    }
  }
  if (machine.all_nodes() > 1) {
    add("bound", "of one node", 1.0, [&] { return Answer{bound_of(frame, machine), {}, ""}; });
  }
}

}  // namespace marti::studies::error
