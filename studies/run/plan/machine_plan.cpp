#include "studies/run/plan/machine_plan.h"

#include <optional>
#include <string>

#include "memory/layout.h"
#include "processors/replay/replay_parts.h"
#include "processors/walk/left_out.h"
#include "processors/walk/record_places.h"
#include "sim/units.h"
#include "studies/tables/text_units.h"

namespace marti::studies::run {

namespace {

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
                                    const processors::program::WorkLog& log, bool observed) {
  const char* waits = processors::walk::why_read_events(machine);
  if (waits == nullptr && observed) {
    waits = "observers need every read";
  }
  PlanEntry contention = entry_of(PlanItem::contention, waits, kept);
  if (waits == nullptr) {
    contention.fact = "over an ideal interconnect every read takes the same time and nothing waits";
  }

  std::optional<processors::walk::TreePlan> given;
  const memory::Layout layout = processors::walk::layout_of(log, machine, given);
  const char* const lookups = processors::walk::why_lookups(machine, layout);
  PlanEntry cache = entry_of(PlanItem::cache, lookups, kept);
  if (lookups == nullptr) {
    cache.fact = "the database of " + tables::bytes(static_cast<double>(layout.database_bytes())) +
                 " fits the cache of " +
                 sim::print_size(static_cast<std::int64_t>(machine.cache.cache.size)) +
                 ", set by set: only first references miss";
  }
  return {std::move(contention), std::move(cache)};
}

}  // namespace marti::studies::run
