// Cases of size: machines of one node to the largest, packets of a pixel to the whole image.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "processors/cost/step_time.h"
#include "processors/replay/bounds.h"
#include "studies/run/run_result.h"
#include "studies/show/output.h"
#include "studies/show/result_json.h"
#include "studies/show/summary.h"
#include "studies/stability/machines.h"

namespace marti::studies::stability {

namespace {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;

/// Whether the counts that do not depend on the machine are right; also checks that no time is below its
/// bounds.
bool whole_frame(const MachineConfig& machine, const MachineResult& result) {
  const processors::program::LogTotals totals = processors::program::totals_of(small_log());
  const processors::cost::StepCounts steps = result.steps();
  processors::replay::check_bounds(machine, result);
  return steps.pixels == std::int64_t{small_log().width} * small_log().height &&
         steps.tests == static_cast<std::int64_t>(totals.tests) &&
         steps.branches == static_cast<std::int64_t>(totals.branches) &&
         steps.shades == static_cast<std::int64_t>(totals.shades);
}

CaseOutcome node_counts(const CaseSize& size) {
  Tally tally;
  for (const std::uint32_t nodes : {1U, 2U, 3U, 16U, 17U, 1024U, size.nodes}) {
    for (const auto assignment :
         {processors::machine::Assignment::dynamic, processors::machine::Assignment::interleaved,
          processors::machine::Assignment::blocks}) {
      MachineConfig machine;
      machine.nodes = nodes;
      machine.packets = {1, 1, processors::machine::PacketOrder::morton};
      machine.host.assignment = assignment;
      const MachineResult result = processors::replay::replay(small_log(), machine);
      sim::Ticks sum = 0;
      for (const processors::cost::NodeStatistics& node : result.nodes) {
        sum += std::llabs(processors::cost::sum_of(node.time) - result.end);
      }
      tally.add(sum == 0 && result.nodes.size() == nodes && whole_frame(machine, result));
    }
  }
  return none_wrong(tally, fmt::format("machines differ, up to {} nodes", tables::grouped(size.nodes)));
}

/// Looks for NaN and infinities in everything that `marti run` prints.
CaseOutcome printed(const CaseSize& size) {
  const std::uint32_t nodes = std::min(size.nodes, 4096U);
  const std::string text =
      "[scene]\nsource = \"tetra:1\"\n[image]\nwidth = 16\nheight = 12\n[machine]\nnodes = " +
      std::to_string(nodes) + "\n[packets]\nwidth = 4\nheight = 4\n";
  sim::Config config = sim::Config::from_text(run::run_schema(), text, "more-nodes-than-packets");
  const run::RunResult result = run::run(config);
  Tally tally;
  std::uint64_t idle = 0;
  for (const processors::cost::NodeStatistics& node : result.timed.nodes) {
    idle += processors::replay::had_work(node) ? 0U : 1U;
  }
  for (std::string printed : {show::summary_of(result), show::json_of(result)}) {
    std::ranges::transform(printed, printed.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* word : {" nan", "-nan", ":nan", " inf ", "-inf", ":inf", "(nan", "nan%"}) {
      tally.add(printed.find(word) == std::string::npos);
    }
  }
  CaseOutcome outcome = none_wrong(tally, "words found");
  outcome.value += idle > 0 ? 0.0 : 1.0;
  outcome.figure +=
      fmt::format("; {} of {} nodes had no work", tables::grouped(idle), tables::grouped(nodes));
  return outcome;
}

CaseOutcome packet_shapes() {
  Tally tally;
  for (const auto& [width, height] :
       {std::pair<std::uint32_t, std::uint32_t>{1, 1}, {24, 16}, {7, 5}, {1, 16}, {24, 1}, {1000, 1000}}) {
    for (const auto order :
         {processors::machine::PacketOrder::scanline, processors::machine::PacketOrder::morton,
          processors::machine::PacketOrder::hilbert}) {
      MachineConfig machine;
      machine.nodes = 5;
      machine.packets = {width, height, order};
      tally.add(whole_frame(machine, processors::replay::replay(small_log(), machine)));
    }
  }
  return none_wrong(tally, "packets differ");
}

/// Memory that takes no time: the frame is the computing of the busiest node.
CaseOutcome perfect_memory() {
  Tally tally;
  for (const std::uint32_t nodes : {1U, 3U, 64U}) {
    MachineConfig machine;
    machine.nodes = nodes;
    machine.packets = {1, 1, processors::machine::PacketOrder::scanline};
    machine.host.assignment = processors::machine::Assignment::interleaved;
    machine.interconnect.kind = memory::InterconnectKind::ideal;
    machine.interconnect.latency_cycles = 0;
    const MachineResult result = processors::replay::replay(small_log(), machine);
    const processors::cost::StepTicks ticks = processors::cost::step_ticks(machine, small_log());
    sim::Ticks most = 0;
    for (const processors::cost::NodeStatistics& node : result.nodes) {
      processors::cost::TimeDivision counted{};
      processors::cost::add_counted_time(ticks, node.steps, node.references.all_hits(), counted);
      most = std::max(most, processors::cost::sum_of(counted));
    }
    tally.add(result.end == most);
  }
  return none_wrong(tally, "machines differ");
}

/// A bus of one byte a beat: its busy time is that of the addresses and every byte.
CaseOutcome narrow_bus() {
  Tally tally;
  for (const std::uint32_t width : {1U, 3U, 8U, 4096U}) {
    for (const std::uint32_t banks : {1U, 64U}) {
      MachineConfig machine;
      machine.nodes = 9;
      machine.cache.cache = {512, 32, 2};
      machine.interconnect.width = width;
      machine.interconnect.clock = sim::Clock::from_period(7);
      machine.banks.count = banks;
      const MachineResult result = processors::replay::replay(small_log(), machine);
      const memory::InterconnectStatistics& bus = result.clusters[0].interconnect;
      // Lines are read, and pixels of 4 bytes written.
      const auto beats = [width](std::int64_t bytes) { return (bytes + width - 1) / width; };
      const std::int64_t pixel = (bus.bytes - 32 * bus.reads) / std::max<std::int64_t>(1, bus.writes);
      const sim::Ticks expected = 7 * (bus.reads * (1 + beats(32)) + bus.writes * (1 + beats(pixel)));
      std::int64_t accesses = 0;
      for (const memory::BankStatistics& bank : result.clusters[0].banks) {
        accesses += bank.accesses;
      }
      tally.add(bus.busy == expected && accesses == bus.reads + bus.writes && whole_frame(machine, result));
    }
  }
  return none_wrong(tally, "buses differ");
}

}  // namespace

void add_scale_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::machine);
  add("node-counts", "1, 2, 3, 16, 17, 1,024 and the most nodes, most of them without work",
      "the log's steps, all and once; every node's time adds up to the end", node_counts);
  add("no-nan-printed", "nodes without references divide 0 by 0", "no nan or inf in summary and JSON",
      printed);
  add("packet-shapes", "packets of a pixel, of more than the image, not dividing it",
      "the log's steps, all and once", packet_shapes);
  add("perfect-memory", "memory that takes no time", "the frame is the most that one node computes",
      perfect_memory);
  add("bus-widths", "a bus of 1 byte to 4 KiB a beat, 1 and 64 banks",
      "busy time is beats and addresses, to the tick", narrow_bus);
}

}  // namespace marti::studies::stability
