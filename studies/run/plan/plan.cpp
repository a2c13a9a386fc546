#include "studies/run/plan/plan.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "sim/error.h"
#include "sim/joined.h"
#include "sim/nearest.h"

namespace marti::studies::run {

namespace {

constexpr std::string_view everything = "all";

}  // namespace

KeptItems::KeptItems(std::span<const std::string> names) {
  for (const std::string& name : names) {
    if (name == everything) {
      bits_.set();
      continue;
    }
    const auto* const at = std::ranges::find(plan_item_names, name);
    if (at == plan_item_names.end()) {
      std::vector<std::string> known(plan_item_names.begin(), plan_item_names.end());
      known.emplace_back(everything);
      throw sim::UserError("--keep: the plan has no item \"" + name + "\"" + sim::did_you_mean(name, known) +
                           "; it has " + sim::listed(known));
    }
    bits_.set(static_cast<std::size_t>(at - plan_item_names.begin()));
  }
}

KeptItems KeptItems::all() {
  KeptItems kept;
  kept.bits_.set();
  return kept;
}

KeptItems KeptItems::all_but_shadow_rays() {
  KeptItems kept = all();
  kept.bits_.reset(static_cast<std::size_t>(PlanItem::shadow_rays));
  return kept;
}

void add_entries(Plan& plan, std::vector<PlanEntry> entries) {
  plan.entries.insert(plan.entries.end(), std::make_move_iterator(entries.begin()),
                      std::make_move_iterator(entries.end()));
  std::ranges::stable_sort(plan.entries, {}, &PlanEntry::item);
}

}  // namespace marti::studies::run
