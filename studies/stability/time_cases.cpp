// Cases of stiff machines: every time scale at once, and none.
#include <cstdlib>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "processors/cost/step_time.h"
#include "processors/replay/bounds.h"
#include "studies/stability/machines.h"

namespace marti::studies::stability {

namespace {

using processors::cost::Activity;
using processors::machine::MachineConfig;
using processors::replay::MachineResult;

sim::Ticks spent(const processors::cost::NodeStatistics& node, Activity activity) {
  return node.time[static_cast<std::size_t>(activity)];
}

/// Keeps all events, also those whose result is known beforehand: they are what these cases test.
MachineResult replay_all(const processors::program::WorkLog& log, const MachineConfig& machine) {
  return processors::replay::replay(log, machine, {.keep_lookups = true, .keep_read_events = true});
}

/// All durations of a machine times 1, 10, ... 1e9.
CaseOutcome homogeneous(const MachineConfig& machine) {
  const MachineResult base = replay_all(small_log(), machine);
  Tally tally;
  std::int64_t factor = 1;
  for (int k = 1; k <= 9; ++k) {
    factor *= 10;
    MachineConfig slow = machine;
    tally.add(stretch(slow, factor) && is_stretched(base, replay_all(small_log(), slow), factor));
  }
  CaseOutcome outcome = none_wrong(tally, "scales differ");
  outcome.figure += fmt::format("; {} events at each", tables::grouped(base.events));
  return outcome;
}

MachineConfig one_node_with(std::int64_t ratio) {
  MachineConfig machine;
  machine.nodes = 1;
  machine.clock = sim::Clock::from_period(5);
  machine.interconnect.clock = sim::Clock::from_period(5);
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.latency_cycles = ratio;
  machine.cache.cache.size = 2048;
  machine.cache.cache.ways = 2;
  machine.write_buffer = 1024;
  return machine;
}

/// A hit takes one cycle, a miss `ratio`: the frame's time is known in advance.
CaseOutcome stiff(std::int64_t ratio) {
  const MachineConfig machine = one_node_with(ratio);
  const MachineResult result = replay_all(small_log(), machine);
  const std::uint64_t events_at_one = replay_all(small_log(), one_node_with(1)).events;
  const processors::cost::NodeStatistics& node = result.nodes[0];
  processors::cost::TimeDivision counted{};
  processors::cost::add_counted_time(processors::cost::step_ticks(machine, small_log()), node.steps,
                                     node.references.all_hits(), counted);
  const sim::Ticks stalled = spent(node, Activity::interconnect_wait) + spent(node, Activity::transfer) +
                             spent(node, Activity::bank_wait) + spent(node, Activity::bank_access);
  const sim::Ticks expected = processors::cost::sum_of(counted) + node.references.all_misses() * 5 * ratio;
  const sim::Ticks got = processors::cost::sum_of(node.time) - spent(node, Activity::dispatch_wait) -
                         spent(node, Activity::queue_full_wait) - spent(node, Activity::idle);
  const auto off = static_cast<double>(std::llabs(got - expected)) +
                   static_cast<double>(std::llabs(stalled - node.references.all_misses() * 5 * ratio)) +
                   (result.events == events_at_one ? 0.0 : 1.0);
  return {fmt::format("{:g} ps and events off; {} hits, {} misses, {} events", off,
                      tables::grouped(static_cast<std::uint64_t>(node.references.all_hits())),
                      tables::grouped(static_cast<std::uint64_t>(node.references.all_misses())),
                      tables::grouped(result.events)),
          off, 0.0};
}

/// Many nodes behind a bus a thousand million times slower than they.
CaseOutcome stiff_and_crowded() {
  MachineConfig machine;
  machine.nodes = 64;
  machine.packets = {1, 1, processors::machine::PacketOrder::scanline};
  machine.clock = sim::Clock::from_period(1);
  machine.banks.count = 1;
  machine.banks.clock = sim::Clock::from_period(1'000'000'000);
  const MachineResult result = replay_all(small_log(), machine);
  processors::replay::check_bounds(machine, result);
  // The one bank is all that takes time: it is busy from the first access to the last.
  const processors::replay::FrameBounds bounds = processors::replay::frame_bounds(machine, result);
  const double idle = 1.0 - static_cast<double>(bounds.bank) / static_cast<double>(result.end);
  return error_within(idle, 1e-4, "share of the frame in which the one bank was idle");
}

CaseOutcome without_time() {
  Tally tally;
  for (const NamedTiming& one : machines_of_every_kind(processors::machine::Assignment::interleaved)) {
    MachineConfig machine = one.machine;
    const MachineResult usual = replay_all(small_log(), machine);
    take_all_time_away(machine);
    const MachineResult result = replay_all(small_log(), machine);
    // Where rays move, contexts take turns or a tree is shared, the order of events decides what a cache
    // holds; and a node that builds a branch reads more.
    const bool own_order = machine.scheme == processors::machine::Scheme::image && machine.contexts == 1;
    const bool given = machine.build.sharing == processors::machine::Sharing::given;
    tally.add(result.end == 0 &&
              (!given || result.references().references() == usual.references().references()) &&
              (!given || !own_order || same_references(usual, result)));
  }
  return none_wrong(tally, "machines differ");
}

CaseOutcome without_time_dynamic() {
  Tally tally;
  for (NamedTiming& one : machines_of_every_kind()) {
    take_all_time_away(one.machine);
    const MachineResult result = replay_all(small_log(), one.machine);
    tally.add(result.end == 0 && result.packets > 0);
  }
  return none_wrong(tally, "machines differ");
}

/// One duration after the other is 0, while the others are not.
CaseOutcome without_one_time() {
  Tally tally;
  const auto differs = [&](auto&& change) {
    MachineConfig machine =
        machines_of_every_kind(processors::machine::Assignment::interleaved).front().machine;
    const MachineResult usual = replay_all(small_log(), machine);
    change(machine);
    tally.add(same_references(usual, replay_all(small_log(), machine)));
  };
  differs([](MachineConfig& m) { m.operations = {0, 0, 0, 0, 0, 0, 0, 0}; });
  differs([](MachineConfig& m) { m.cache.hit_cycles = 0; });
  differs([](MachineConfig& m) { m.interconnect.cycles_per_beat = 0; });
  differs([](MachineConfig& m) { m.interconnect.address_cycles = 0; });
  differs([](MachineConfig& m) { m.banks.access_cycles = 0; });
  differs([](MachineConfig& m) { m.banks.busy_cycles = 0; });
  differs([](MachineConfig& m) { m.banks.busy_cycles = m.banks.access_cycles = std::int64_t{1} << 40; });
  return none_wrong(tally, "machines differ");
}

}  // namespace

void add_time_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::machine);
  for (const NamedTiming& one : machines_of_every_kind()) {
    add("durations-" + one.id(),
        "all durations times 10 to 1e9 (" + one.name + "): rounding or truncation changes the course",
        "every time is multiplied exactly, events are as many",
        [machine = one.machine] { return homogeneous(machine); });
  }
  for (const auto& [ratio, name] : {std::pair<std::int64_t, const char*>{1, "1"},
                                    {100, "1e2"},
                                    {1'000'000, "1e6"},
                                    {1'000'000'000, "1e9"}}) {
    add(fmt::format("hit-to-miss-{}", name),
        fmt::format("a miss takes {} hits: the frame's time loses its small parts, or events grow", name),
        "compute + hits + misses * latency, to the tick; events as at 1:1",
        [ratio = ratio] { return stiff(ratio); });
  }
  add("slow-bank", "64 nodes behind one bank 1e9 times slower than they", "the bank is never idle",
      stiff_and_crowded);
  add("zero-latencies", "nothing takes time: events at one tick never end",
      "ends at 0, with the hits and misses of any other latency", without_time);
  add("zero-latencies-dynamic", "nothing takes time and packets are asked for", "ends at 0, every law holds",
      without_time_dynamic);
  add("one-zero-latency", "a single duration is 0 or 2^40, the others are not",
      "hits and misses of any other latency", without_one_time);
}

}  // namespace marti::studies::stability
