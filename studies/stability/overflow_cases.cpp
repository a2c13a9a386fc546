// Cases near the end of time: 2^63 ticks.
#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "processors/bounds.h"
#include "sim/error.h"
#include "studies/stability/machines.h"

namespace marti::studies {

namespace {

using processors::MachineConfig;
using processors::MachineResult;

/// Sums of waits reach beyond the frame's end: so many may wait at a time, all frame long.
constexpr sim::Ticks most_waiting = std::int64_t{1} << 20;

/// A machine with all durations times 2^k, for every k: a frame that fits is timed exactly, one that does not
/// is refused as the user's.
CaseOutcome up_to_the_end(const MachineConfig& machine) {
  const MachineResult base = processors::replay(small_log(), machine);
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
      const MachineResult result = processors::replay(small_log(), slow);
      processors::check_bounds(slow, result);
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

/// A single duration so long that a few of them do not fit, one after the other.
CaseOutcome long_durations() {
  constexpr std::int64_t most = std::int64_t{1} << 60;
  Tally tally;
  for (const NamedTiming& one : machines_of_every_kind()) {
    const auto refused_or_whole = [&](auto&& change) {
      MachineConfig machine = one.machine;
      change(machine);
      try {
        const MachineResult result = processors::replay(small_log(), machine);
        tally.add(result.end >= 0);
      } catch (const sim::UserError&) {
        tally.add(true);
      } catch (const sim::InternalError&) {
        tally.add(false);
      }
    };
    refused_or_whole([](MachineConfig& m) { m.operations.add = most; });
    refused_or_whole([](MachineConfig& m) { m.cache.hit_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.banks.access_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.banks.busy_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.interconnect.latency_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.interconnect.cycles_per_beat = most; });
    refused_or_whole([](MachineConfig& m) { m.interconnect.address_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.network.hop_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.network.cycles_per_beat = most; });
    refused_or_whole([](MachineConfig& m) { m.messages.send_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.messages.receive_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.host.latency_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.host.occupancy_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.local.access_cycles = most; });
    refused_or_whole([](MachineConfig& m) { m.switch_cycles = most; });
  }
  return none_wrong(tally, "machines wrapped or were called our fault");
}

CaseOutcome sums_of_times() {
  return refuses([] { (void)sim::add_ticks(std::numeric_limits<sim::Ticks>::max() - 999'999, 1'000'000); },
                 "time");
}

}  // namespace

void add_overflow_cases(std::vector<StabilityCase>& cases) {
  for (const NamedTiming& one : machines_of_every_kind()) {
    std::string id = "end-of-time-" + one.name;
    std::replace(id.begin(), id.end(), ' ', '-');
    cases.push_back({id, CaseGroup::machine,
                     "durations times 2 to 2^61 (" + one.name + "): times near 2^63 ticks wrap",
                     "multiplied exactly, or refused as the user's input",
                     [machine = one.machine](const CaseSize&) { return up_to_the_end(machine); }});
  }
  cases.push_back({"long-durations", CaseGroup::machine, "one duration of 2^60 cycles overflows some sum",
                   "a time, or refused as the user's input",
                   [](const CaseSize&) { return long_durations(); }});
  cases.push_back({"last-tick", CaseGroup::machine, "an event after 2^63 - 10^6 is scheduled in the past",
                   "refused as the user's input", [](const CaseSize&) { return sums_of_times(); }});
}

}  // namespace marti::studies
