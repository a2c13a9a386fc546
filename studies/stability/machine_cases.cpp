// Cases of the user's machine: times, caches, packets and numbers of nodes from one end to the other.
#include <algorithm>
#include <atomic>
#include <bit>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "processors/replay/bounds.h"
#include "processors/replay/host_bytes.h"
#include "sim/error.h"
#include "studies/stability/stability_case.h"
#include "studies/tables/text_units.h"

namespace marti::studies::stability {

namespace {

using processors::machine::MachineConfig;
using processors::machine::Scheme;
using processors::replay::MachineResult;

/// A duration of a machine, in cycles, by the name of its key.
struct Duration {
  std::string_view key;
  std::int64_t& (*of)(MachineConfig& machine);
};

/// All but those of DRAM.
const std::vector<Duration>& durations() {
  using M = MachineConfig;
  static const std::vector<Duration> all = {
      {"costs.add", [](M& m) -> std::int64_t& { return m.operations.add; }},
      {"costs.multiply", [](M& m) -> std::int64_t& { return m.operations.multiply; }},
      {"costs.divide", [](M& m) -> std::int64_t& { return m.operations.divide; }},
      {"costs.square_root", [](M& m) -> std::int64_t& { return m.operations.square_root; }},
      {"costs.compare", [](M& m) -> std::int64_t& { return m.operations.compare; }},
      {"costs.integer", [](M& m) -> std::int64_t& { return m.operations.integer; }},
      {"costs.load", [](M& m) -> std::int64_t& { return m.operations.load; }},
      {"costs.store", [](M& m) -> std::int64_t& { return m.operations.store; }},
      {"node.switch_cycles", [](M& m) -> std::int64_t& { return m.switch_cycles; }},
      {"rt.box_cycles", [](M& m) -> std::int64_t& { return m.rt.box_cycles; }},
      {"rt.transform_cycles", [](M& m) -> std::int64_t& { return m.rt.transform_cycles; }},
      {"rt.leaf_cycles", [](M& m) -> std::int64_t& { return m.rt.leaf_cycles; }},
      {"rt.triangle_cycles", [](M& m) -> std::int64_t& { return m.rt.triangle_cycles; }},
      {"rt.quadric_cycles", [](M& m) -> std::int64_t& { return m.rt.quadric_cycles; }},
      {"rt.sort_cycles", [](M& m) -> std::int64_t& { return m.rt.sort_cycles; }},
      {"cache.hit_cycles", [](M& m) -> std::int64_t& { return m.cache.hit_cycles; }},
      {"l2.hit_cycles", [](M& m) -> std::int64_t& { return m.l2.hit_cycles; }},
      {"local.access_cycles", [](M& m) -> std::int64_t& { return m.local.access_cycles; }},
      {"local.cycles_per_beat", [](M& m) -> std::int64_t& { return m.local.cycles_per_beat; }},
      {"interconnect.cycles_per_beat", [](M& m) -> std::int64_t& { return m.interconnect.cycles_per_beat; }},
      {"interconnect.address_cycles", [](M& m) -> std::int64_t& { return m.interconnect.address_cycles; }},
      {"interconnect.latency_cycles", [](M& m) -> std::int64_t& { return m.interconnect.latency_cycles; }},
      {"memory.access_cycles", [](M& m) -> std::int64_t& { return m.banks.access_cycles; }},
      {"memory.busy_cycles", [](M& m) -> std::int64_t& { return m.banks.busy_cycles; }},
      {"network.cycles_per_beat", [](M& m) -> std::int64_t& { return m.network.cycles_per_beat; }},
      {"network.hop_cycles", [](M& m) -> std::int64_t& { return m.network.hop_cycles; }},
      {"host.latency_cycles", [](M& m) -> std::int64_t& { return m.host.latency_cycles; }},
      {"host.occupancy_cycles", [](M& m) -> std::int64_t& { return m.host.occupancy_cycles; }},
      {"messages.send_cycles", [](M& m) -> std::int64_t& { return m.messages.send_cycles; }},
      {"messages.receive_cycles", [](M& m) -> std::int64_t& { return m.messages.receive_cycles; }},
  };
  return all;
}

/// All but that of DRAM.
std::vector<sim::Clock*> clocks_of(MachineConfig& machine) {
  std::vector<sim::Clock*> clocks = {
      &machine.clock,       &machine.local.clock,   &machine.interconnect.clock,
      &machine.banks.clock, &machine.network.clock, &machine.host.clock};
  if (machine.l2.clock) {
    clocks.push_back(&*machine.l2.clock);
  }
  return clocks;
}

/// Multiplies every duration of the machine by `factor`; false when a clock's period would not fit.
bool stretch(MachineConfig& machine, std::int64_t factor) {
  for (sim::Clock* const clock : clocks_of(machine)) {
    sim::Ticks period = 0;
    if (__builtin_mul_overflow(clock->period(), factor, &period)) {
      return false;
    }
    *clock = sim::Clock::from_period(period);
  }
  return !machine.banks.dram ||
         !__builtin_mul_overflow(machine.banks.dram->period, factor, &machine.banks.dram->period);
}

/// Replays with all events, also those whose result is known beforehand: they are what is tried.
MachineResult replay_all(const Subject& subject, const MachineConfig& machine) {
  return processors::replay::replay(*subject.log, machine, {.keep_lookups = true, .keep_read_events = true});
}

bool builds(const MachineConfig& machine) {
  return machine.build.sharing != processors::machine::Sharing::given;
}

/// Whether the order of events decides nothing about what each node reads, and in which order.
bool reads_in_order(const MachineConfig& machine) {
  return machine.kind == processors::machine::NodeKind::core && machine.scheme == Scheme::image &&
         machine.contexts == 1 && !machine.prefetch.on() && !builds(machine);
}

/// A machine that is tried, and what must hold of its result.
struct Trial {
  std::string name;
  MachineConfig machine;
  std::function<bool(const MachineResult&)> holds;
  /// Whether it may be refused as the user's input: a machine that cannot be, or a time that does not fit.
  bool may_be_refused = true;
};

/// Whether replays of the machine on all host threads fit the memory that is left.
bool fits(const Subject& subject, const MachineConfig& machine) {
  const auto threads = static_cast<std::uint64_t>(tbb::this_task_arena::max_concurrency());
  return subject.frame.memory.excess(threads * processors::replay::host_bytes(*subject.log, machine)).empty();
}

/// Replays each trial; those whose result does not hold, or breaks a law or a bound, are wrong. A replay
/// checks that each node's time adds up to the frame's, that every pixel is written once, and so on.
CaseOutcome replayed(const Subject& subject, const std::vector<Trial>& trials, std::string_view what) {
  std::atomic<std::uint64_t> refused = 0;
  std::vector<std::string> objections(trials.size());
  tbb::parallel_for(std::size_t{0}, trials.size(), [&](std::size_t k) {
    const Trial& trial = trials[k];
    try {
      if (!fits(subject, trial.machine)) {
        throw sim::UserError("too large for this computer");
      }
      const MachineResult result = replay_all(subject, trial.machine);
      processors::replay::check_bounds(trial.machine, result);
      (void)result.time();
      objections[k] = trial.holds(result) ? "" : trial.name + " differs";
    } catch (const sim::UserError& error) {
      ++refused;
      objections[k] = trial.may_be_refused ? "" : trial.name + ": " + error.what();
    } catch (const sim::InternalError& error) {  // a law or a bound that does not hold
      objections[k] = trial.name + ": " + error.what();
    }
  });
  Tally tally;
  std::string first;
  for (const std::string& objection : objections) {
    tally.add(objection.empty());
    first = first.empty() ? objection : first;
  }
  CaseOutcome outcome = none_wrong(tally, what);
  if (refused > 0) {
    outcome.figure += fmt::format("; {} refused as the user's input", tables::grouped(refused));
  }
  outcome.figure += first.empty() ? "" : "; first: " + first;
  return outcome;
}

/// The steps that the frame takes on any machine: none is lost and none is done twice.
std::function<bool(const MachineResult&)> same_steps(const Subject& subject) {
  const processors::cost::StepCounts expected = replay_all(subject, subject.machine).steps();
  const bool any = builds(subject.machine);
  return [expected, any](const MachineResult& result) {
    const processors::cost::StepCounts steps = result.steps();
    return steps.pixels == expected.pixels && steps.shades == expected.shades &&
           steps.lights == expected.lights &&
           (any || (steps.tests == expected.tests && steps.branches == expected.branches));
  };
}

/// All durations times each factor. Times that add up to more than 2^63 ticks are refused: the waits of all
/// that may wait at a time, all frame long.
CaseOutcome stretched(const Subject& subject, const std::vector<std::int64_t>& factors) {
  const MachineConfig& machine = subject.machine;
  const MachineResult base = replay_all(subject, machine);
  const sim::Ticks waiting =
      (std::int64_t{1} << 20) + 16 * std::int64_t{machine.all_nodes()} * machine.ports_of_node();
  // Commands of a DRAM's queue are decided a tick after what they may depend on, whatever a tick is.
  const bool late = machine.banks.dram && machine.banks.dram->policy == memory::DramPolicy::frfcfs;
  std::vector<Trial> trials;
  for (const std::int64_t factor : factors) {
    MachineConfig slow = machine;
    if (!stretch(slow, factor)) {
      break;
    }
    trials.push_back({fmt::format("all times {}", factor), slow,
                      [&base, factor, late](const MachineResult& result) {
                        return is_stretched(base, result, factor, !late);
                      },
                      base.end > std::numeric_limits<sim::Ticks>::max() / factor / waiting});
  }
  return replayed(subject, trials, "scales neither exact nor refused");
}

std::vector<std::int64_t> powers(std::int64_t of, int most) {
  std::vector<std::int64_t> all;
  std::int64_t power = 1;
  for (int k = 0; k < most; ++k) {
    all.push_back(power *= of);
  }
  return all;
}

/// One duration after the other is 0, or so long that a few or many of them do not fit; and one clock after
/// the other is as fast as can be, or up to a thousand million times slower than the others.
CaseOutcome single_times(const Subject& subject) {
  const auto holds = same_steps(subject);
  std::vector<Trial> trials;
  for (const Duration& duration : durations()) {
    for (const std::int64_t cycles : {std::int64_t{0}, std::int64_t{1} << 40, std::int64_t{1} << 60}) {
      MachineConfig machine = subject.machine;
      duration.of(machine) = cycles;
      trials.push_back({fmt::format("{} = {}", duration.key, cycles), machine, holds});
    }
  }
  MachineConfig machine = subject.machine;
  for (std::size_t k = 0; k < clocks_of(machine).size(); ++k) {
    const sim::Ticks usual = clocks_of(machine)[k]->period();
    for (const sim::Ticks period : {sim::Ticks{1}, usual * 1'000'000, usual * 1'000'000'000}) {
      machine = subject.machine;
      *clocks_of(machine)[k] = sim::Clock::from_period(period);
      trials.push_back({fmt::format("clock {} of {} ps", k, period), machine, holds});
    }
  }
  return replayed(subject, trials, "machines neither timed nor refused");
}

/// Nothing takes time.
CaseOutcome without_time(const Subject& subject) {
  if (subject.machine.kind == processors::machine::NodeKind::simt) {
    return not_tried("a look-up of a SIMT node takes a cycle at least");
  }
  MachineConfig machine = subject.machine;
  machine.banks.dram.reset();  // its commands take a cycle at least
  for (const Duration& duration : durations()) {
    duration.of(machine) = 0;
  }
  const auto steps = same_steps(subject);
  return replayed(
      subject,
      {{"it", machine, [&](const MachineResult& result) { return result.end == 0 && steps(result); }, false}},
      "frames take time");
}

/// So many nodes in each cluster, most of them without work.
CaseOutcome node_counts(const Subject& subject) {
  const auto holds = same_steps(subject);
  std::vector<Trial> trials;
  std::uint32_t most = 0;
  for (const std::uint32_t nodes : {1U, 2U, 3U, 16U, 17U, 1024U, subject.nodes}) {
    if (nodes > subject.nodes) {
      continue;
    }
    MachineConfig machine = subject.machine;
    machine.nodes = nodes;
    if (machine.scheme == Scheme::pipeline && nodes >= processors::machine::pipeline_stages) {
      machine.pipeline = processors::machine::default_stages(nodes);
    }
    trials.push_back({fmt::format("{} nodes", nodes), machine, holds});
    most = nodes;
  }
  return replayed(subject, trials, fmt::format("machines differ, up to {} nodes", tables::grouped(most)));
}

CaseOutcome packet_shapes(const Subject& subject) {
  const auto holds = same_steps(subject);
  const std::uint32_t width = subject.log->width;
  const std::uint32_t height = subject.log->height;
  std::vector<Trial> trials;
  for (const auto& [w, h] :
       {std::pair{1U, 1U}, {width, height}, {7U, 5U}, {1U, height}, {width, 1U}, {1000U, 1000U}}) {
    MachineConfig machine = subject.machine;
    machine.packets.width = w;
    machine.packets.height = h;
    trials.push_back({fmt::format("{} x {}", w, h), machine, holds});
  }
  return replayed(subject, trials, "packets differ");
}

/// Caches of one line to more than the database, and of lines of a byte to a MiB.
CaseOutcome caches(const Subject& subject) {
  if (subject.machine.cache.organisation != processors::machine::CacheOrganisation::unified) {
    return not_tried("the nodes have no unified cache");
  }
  MachineConfig base = subject.machine;
  base.host.assignment = processors::machine::Assignment::interleaved;
  const auto with = [&](const memory::CacheConfig& cache) {
    MachineConfig machine = base;
    machine.cache.cache = cache;
    return machine;
  };
  const std::uint32_t line = base.cache.cache.line;
  // Every address of the database, the gaps before its sections included: then no two lines of it share a
  // set.
  const std::uint64_t all =
      std::bit_ceil(replay_all(subject, base).database_bytes + line +
                    memory::record_kinds * std::uint64_t{base.layout.section_alignment});
  const MachineConfig largest = with({all, line, memory::full_ways});
  if (!fits(subject, largest)) {
    return not_tried("caches of the whole database are too large for this computer");
  }
  const processors::cost::ReferenceCounts least = replay_all(subject, largest).references();
  const bool comparable = reads_in_order(base);
  const auto steps = same_steps(subject);
  std::vector<Trial> trials;
  using memory::Replacement;
  for (const memory::CacheConfig& cache : {memory::CacheConfig{line, line, 1},
                                           {4ULL * line, line, memory::full_ways},
                                           {128ULL * line, line, 1},
                                           {128ULL * line, line, 4, Replacement::plru},
                                           {128ULL * line, line, 4, Replacement::random},
                                           {128ULL * line, line, 4, Replacement::srrip},
                                           {3ULL * line, line, 3, Replacement::fifo},
                                           {all, line, memory::full_ways},
                                           {all, line, 1}}) {
    const bool everything = cache.size == all;
    trials.push_back({fmt::format("{} bytes in {} ways", cache.size, cache.ways), with(cache),
                      [=](const MachineResult& result) {
                        const processors::cost::ReferenceCounts counts = result.references();
                        return steps(result) &&
                               (!comparable || (counts.references() == least.references() &&
                                                counts.all_misses() >= least.all_misses() &&
                                                (!everything || counts.all_misses() == least.all_misses())));
                      }});
  }
  for (std::uint32_t other = 1; other <= 1U << 20U; other *= 4) {
    trials.push_back(
        {fmt::format("lines of {} bytes", other), with({std::uint64_t{4} * other, other, 2}), steps});
  }
  CaseOutcome outcome = replayed(subject, trials, "caches differ");
  outcome.figure +=
      fmt::format("; {} misses at least", tables::grouped(static_cast<std::uint64_t>(least.all_misses())));
  return outcome;
}

}  // namespace

bool is_stretched(const MachineResult& short_one, const MachineResult& long_one, std::int64_t factor,
                  bool events) {
  if (short_one.nodes.size() != long_one.nodes.size() || (events && short_one.events != long_one.events) ||
      short_one.end * factor != long_one.end) {
    return false;
  }
  for (std::size_t k = 0; k < short_one.nodes.size(); ++k) {
    const processors::cost::NodeStatistics& a = short_one.nodes[k];
    const processors::cost::NodeStatistics& b = long_one.nodes[k];
    if (a.finish * factor != b.finish || a.packets != b.packets || a.references.hits != b.references.hits ||
        a.references.misses != b.references.misses) {
      return false;
    }
    for (std::size_t activity = 0; activity < processors::cost::activities; ++activity) {
      if (a.time[activity] * factor != b.time[activity]) {
        return false;
      }
    }
  }
  for (std::size_t c = 0; c < short_one.clusters.size(); ++c) {
    const memory::InterconnectStatistics& a = short_one.clusters[c].interconnect;
    const memory::InterconnectStatistics& b = long_one.clusters[c].interconnect;
    if (a.busy * factor != b.busy || a.waits.sum * factor != b.waits.sum ||
        a.waits.max * factor != b.waits.max || a.reads != b.reads || a.bytes != b.bytes) {
      return false;
    }
  }
  return true;
}

void add_machine_cases(std::vector<StabilityCase>& cases) {
  const auto add = [&](const char* id, const char* risk, const char* oracle, auto run) {
    cases.push_back({id, CaseGroup::machine, risk, oracle, std::move(run)});
  };
  add("durations", "all durations times 10 to 1e9: rounding or truncation changes the course",
      "every time is multiplied exactly, events are as many",
      [](const Subject& subject) { return stretched(subject, powers(10, 9)); });
  add("end-of-time", "durations times 2 to 2^61: times near 2^63 ticks wrap",
      "multiplied exactly, or refused as the user's input",
      [](const Subject& subject) { return stretched(subject, powers(2, 61)); });
  add("single-times", "one duration is 0, 2^40 or 2^60 cycles, one clock 1 THz or 1e9 times slower",
      "the same steps and every law, or refused as the user's input", single_times);
  add("no-time", "nothing takes time: events at one tick never end", "ends at 0, with the same steps",
      without_time);
  add("node-counts", "1, 2, 3, 16, 17, 1,024 and the most nodes, many of them without work",
      "the same steps, and every law", node_counts);
  add("packet-shapes", "packets of a pixel, of a row, of more than the image, not dividing it",
      "the same steps, and every law", packet_shapes);
  add("caches", "caches of one line to more than the database, lines of 1 byte to 1 MiB",
      "equal references; misses at least those of an endless cache", caches);
}

}  // namespace marti::studies::stability
