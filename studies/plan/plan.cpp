#include "studies/plan/plan.h"

#include <algorithm>

#include "sim/error.h"
#include "sim/nearest.h"

namespace marti::studies {

namespace {

constexpr std::string_view everything = "all";

}  // namespace

KeptItems::KeptItems(std::span<const std::string> names) {
  for (const std::string& name : names) {
    if (name == everything) {
      bits_.set();
      continue;
    }
    const auto* const at = std::find(plan_item_names.begin(), plan_item_names.end(), name);
    if (at == plan_item_names.end()) {
      std::vector<std::string> known(plan_item_names.begin(), plan_item_names.end());
      known.emplace_back(everything);
      std::string message = "--keep: there is no item \"" + name + "\" of the plan";
      const std::string_view near = sim::nearest_name(name, known);
      if (!near.empty()) {
        message += "; did you mean \"" + std::string(near) + "\"?";
      }
      throw sim::UserError(message);
    }
    bits_.set(static_cast<std::size_t>(at - plan_item_names.begin()));
  }
}

KeptItems KeptItems::all() {
  KeptItems kept;
  kept.bits_.set();
  return kept;
}

}  // namespace marti::studies
