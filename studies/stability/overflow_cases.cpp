// Cases near the end of time: 2^63 ticks.
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "processors/replay/bounds.h"
#include "sim/error.h"
#include "studies/stability/machines.h"

namespace marti::studies::stability {

namespace {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;

/// Sums of waits exceed the frame time: up to so many requests may wait at a time, all frame long.
constexpr sim::Ticks most_waiting = std::int64_t{1} << 20;

/// A machine with all durations times 2^k, for every k: a frame that fits is timed exactly, one that does not
/// is refused as an error of the user's.
CaseOutcome up_to_the_end(const MachineConfig& machine) {
  // Keeps all events, which are what this case tests.
  const processors::replay::ReplayOptions all = {.keep_lookups = true, .keep_read_events = true};
  const MachineResult base = processors::replay::replay(small_log(), machine, all);
  Tally tally;
  int largest = 0;
  std::uint64_t refused = 0;
  for (int k = 1; k < 62; ++k) {
    MachineConfig slow = machine;
    const std::int64_t factor = std::int64_t{1} << k;
    if (!stretch(slow, factor)) {
      break;
    }
    try {
      const MachineResult result = processors::replay::replay(small_log(), slow, all);
      processors::replay::check_bounds(slow, result);
      (void)result.time();
      tally.add(is_stretched(base, result, factor));
      largest = k;
    } catch (const sim::UserError&) {
      ++refused;
      tally.add(base.end > std::numeric_limits<sim::Ticks>::max() / factor / most_waiting);
    }
  }
  CaseOutcome outcome = none_wrong(tally, "scales neither exact nor refused");
  outcome.value += refused == 0 ? 1.0 : 0.0;
  outcome.figure += fmt::format("; exact up to 2^{}, {} refused", largest, refused);
  return outcome;
}

/// One duration of a machine.
struct Duration {
  const char* name;
  void (*set)(MachineConfig&, std::int64_t cycles);
};

constexpr Duration durations[] = {
    {"an addition", [](MachineConfig& m, std::int64_t c) { m.operations.add = c; }},
    {"a hit", [](MachineConfig& m, std::int64_t c) { m.cache.hit_cycles = c; }},
    {"a bank's access", [](MachineConfig& m, std::int64_t c) { m.banks.access_cycles = c; }},
    {"a bank's busy time", [](MachineConfig& m, std::int64_t c) { m.banks.busy_cycles = c; }},
    {"the interconnect", [](MachineConfig& m, std::int64_t c) { m.interconnect.latency_cycles = c; }},
    {"a beat", [](MachineConfig& m, std::int64_t c) { m.interconnect.cycles_per_beat = c; }},
    {"an address", [](MachineConfig& m, std::int64_t c) { m.interconnect.address_cycles = c; }},
    {"a hop", [](MachineConfig& m, std::int64_t c) { m.network.hop_cycles = c; }},
    {"a message's beat", [](MachineConfig& m, std::int64_t c) { m.network.cycles_per_beat = c; }},
    {"sending", [](MachineConfig& m, std::int64_t c) { m.messages.send_cycles = c; }},
    {"receiving", [](MachineConfig& m, std::int64_t c) { m.messages.receive_cycles = c; }},
    {"the host's answer", [](MachineConfig& m, std::int64_t c) { m.host.latency_cycles = c; }},
    {"the host", [](MachineConfig& m, std::int64_t c) { m.host.occupancy_cycles = c; }},
    {"local memory", [](MachineConfig& m, std::int64_t c) { m.local.access_cycles = c; }},
    {"a switch", [](MachineConfig& m, std::int64_t c) { m.switch_cycles = c; }},
};

/// A single duration so long that a few of them do not fit, one after the other; or so long that many do not.
CaseOutcome long_durations() {
  Tally tally;
  std::string objections;
  for (const NamedTiming& one : machines_of_every_kind()) {
    for (const Duration& duration : durations) {
      for (const int bits : {50, 60}) {
        MachineConfig machine = one.machine;
        duration.set(machine, std::int64_t{1} << bits);
        bool good = true;
        try {
          const MachineResult result = processors::replay::replay(small_log(), machine);
          processors::replay::check_bounds(machine, result);
          good = result.end >= 0;
        } catch (const sim::UserError&) {  // refused, which is as good
        } catch (const sim::InternalError& error) {
          objections += fmt::format("; {} of 2^{} ({}): {}", duration.name, bits, one.name, error.what());
          good = false;
        }
        tally.add(good);
      }
    }
  }
  CaseOutcome outcome = none_wrong(tally, "machines neither timed nor refused");
  outcome.figure += objections;
  return outcome;
}

CaseOutcome sums_of_times() {
  return refuses([] { (void)sim::add_ticks(std::numeric_limits<sim::Ticks>::max() - 999'999, 1'000'000); },
                 "time");
}

}  // namespace

void add_overflow_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::machine);
  for (const NamedTiming& one : machines_of_every_kind()) {
    add("end-of-time-" + one.id(), "durations times 2 to 2^61 (" + one.name + "): times near 2^63 ticks wrap",
        "multiplied exactly, or refused as the user's input",
        [machine = one.machine] { return up_to_the_end(machine); });
  }
  add("long-durations", "one duration of 2^60 cycles overflows some sum",
      "a time, or refused as the user's input", long_durations);
  add("last-tick", "an event after 2^63 - 10^6 is scheduled in the past", "refused as the user's input",
      sums_of_times);
}

}  // namespace marti::studies::stability
