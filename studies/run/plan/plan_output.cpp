#include "studies/run/plan/plan_output.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "studies/tables/text_units.h"

namespace marti::studies::run {

namespace {

using Json = nlohmann::ordered_json;

// "saves 1.2 KiB, 300 texels decoded"
std::string saving_text(const PlanEntry& entry) {
  const PlanCost& cost = entry.counted ? *entry.counted : entry.saved;
  std::string text;
  if (cost.bytes > 0) {
    text = tables::bytes(static_cast<double>(cost.bytes));
  }
  if (cost.operations > 0) {
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ",
                        tables::grouped(static_cast<std::int64_t>(cost.operations)), entry.unit);
  }
  return text.empty() ? text : ": saves " + text;
}

std::string names_of(const Plan& plan, PlanDecision decision) {
  std::string names;
  for (const PlanEntry& entry : plan.entries) {
    if (entry.decision == decision) {
      names.append(names.empty() ? "" : ", ").append(name_of(entry.item));
    }
  }
  return names;
}

Json cost_json(const PlanCost& cost) { return {{"bytes", cost.bytes}, {"operations", cost.operations}}; }

}  // namespace

std::string plan_lines(const Plan& plan) {
  std::string text;
  const auto out = std::back_inserter(text);
  const auto head = [&] { return text.empty() ? "plan" : ""; };
  for (const PlanEntry& entry : plan.entries) {
    if (entry.decision == PlanDecision::left_out) {
      fmt::format_to(out, "{:<14}left out: {} ({}){}\n", head(), name_of(entry.item), entry.fact,
                     saving_text(entry));
    }
  }
  for (const auto& [decision, label] :
       {std::pair{PlanDecision::kept, "kept, as asked"}, std::pair{PlanDecision::needed, "needed"}}) {
    const std::string names = names_of(plan, decision);
    if (!names.empty()) {
      fmt::format_to(out, "{:<14}{}: {}\n", head(), label, names);
    }
  }
  return text;
}

Json plan_json(const Plan& plan) {
  Json items = Json::object();
  for (const PlanEntry& entry : plan.entries) {
    items[std::string(name_of(entry.item))] = {
        {"decision", plan_decision_names[static_cast<std::size_t>(entry.decision)]},
        {"class", plan_class_names[static_cast<std::size_t>(entry.kind)]},
        {"fact", entry.fact},
        {"unit", entry.unit},
        {"estimated", cost_json(entry.saved)},
        {"counted", entry.counted ? cost_json(*entry.counted) : Json(nullptr)}};
  }
  return items;
}

}  // namespace marti::studies::run
