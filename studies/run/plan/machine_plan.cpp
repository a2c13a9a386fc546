#include "studies/run/plan/machine_plan.h"

#include <optional>
#include <string>

#include "memory/layout.h"
#include "memory/line_set.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/left_out.h"
#include "processors/walk/record_places.h"
#include "sim/units.h"
#include "studies/tables/text_units.h"

namespace marti::studies::run {

namespace {

// Records that the log's steps refer to; each is one reference at least.
std::int64_t records_of(const processors::program::LogTotals& totals) {
  return static_cast<std::int64_t>(totals.branches + totals.leaves + totals.tests + totals.shades +
                                   totals.texels + totals.cuts + totals.passes);
}

PlanEntry entry_of(PlanItem item, const char* why, const KeptItems& kept) {
  PlanEntry entry;
  entry.item = item;
  entry.decision = why != nullptr   ? PlanDecision::needed
                   : kept.has(item) ? PlanDecision::kept
                                    : PlanDecision::left_out;
  if (why != nullptr) {
    entry.fact = why;
  }
  return entry;
}

}  // namespace

void keep(const KeptItems& kept, processors::replay::ReplayOptions& options) {
  options.keep_lookups = kept.has(PlanItem::cache);
  options.keep_read_events = kept.has(PlanItem::contention);
}

std::vector<PlanEntry> machine_plan(const KeptItems& kept, const processors::machine::MachineConfig& machine,
                                    const processors::program::WorkLog& log,
                                    const processors::program::LogTotals& totals, bool observed) {
  const std::int64_t records = records_of(totals);

  const char* waits = processors::walk::why_read_events(machine);
  if (waits == nullptr && observed) {
    waits = "observers need every read";
  }
  PlanEntry contention = entry_of(PlanItem::contention, waits, kept);
  contention.unit = "read events";
  if (waits == nullptr) {
    contention.fact = "over an ideal interconnect every read takes the same time and nothing waits";
    // Without a cache every reference is a read; with a cache only the run tells how many are.
    if (contention.decision == PlanDecision::left_out &&
        machine.cache.organisation == processors::machine::CacheOrganisation::none) {
      contention.saved.operations = records;
    }
  }

  std::optional<processors::walk::TreePlan> given;
  const memory::Layout layout = processors::walk::layout_of(log, machine, given);
  const char* const lookups = processors::walk::why_lookups(machine, layout);
  PlanEntry cache = entry_of(PlanItem::cache, lookups, kept);
  cache.unit = "look-ups in tags";
  if (lookups == nullptr) {
    const std::uint64_t lines = processors::walk::lines_of(layout, machine.cache.cache.line);
    cache.fact = "the database of " + tables::bytes(static_cast<double>(layout.database_bytes())) +
                 " fits the cache of " +
                 sim::print_size(static_cast<std::int64_t>(machine.cache.cache.size)) +
                 ", set by set: only first references miss";
    if (cache.decision == PlanDecision::left_out) {
      const std::uint64_t tags = memory::shape_of(machine.cache.cache).lines() * sizeof(std::uint32_t);
      cache.saved.operations = records;
      cache.saved.bytes = static_cast<std::int64_t>(tags * machine.all_nodes()) -
                          static_cast<std::int64_t>((lines + 7) / 8 * machine.all_nodes());
    }
  }
  return {std::move(contention), std::move(cache)};
}

void count_machine_plan(const processors::replay::MachineResult& result, std::vector<PlanEntry>& entries) {
  const processors::walk::LeftOut& left = result.left_out;
  for (PlanEntry& entry : entries) {
    if (entry.item == PlanItem::contention && left.read_events) {
      entry.counted = PlanCost{0, left.reads};
    } else if (entry.item == PlanItem::cache && left.lookups) {
      entry.counted =
          PlanCost{static_cast<std::int64_t>(left.tag_bytes) - static_cast<std::int64_t>(left.line_set_bytes),
                   left.references};
    }
  }
}

}  // namespace marti::studies::run
