#include "studies/run/plan/plan_output.h"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

namespace marti::studies::run {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

std::string plan_lines(const Plan& plan) {
  std::string text;
  for (const PlanEntry& entry : plan.entries) {
    if (entry.decision == PlanDecision::left_out || entry.decision == PlanDecision::kept) {
      fmt::format_to(std::back_inserter(text), "{:<14}{}: {} ({})\n", text.empty() ? "plan" : "",
                     plan_decision_names[static_cast<std::size_t>(entry.decision)], name_of(entry.item),
                     entry.fact);
    }
  }
  return text;
}

Json plan_json(const Plan& plan) {
  Json items = Json::object();
  for (const PlanEntry& entry : plan.entries) {
    items[std::string(name_of(entry.item))] = {
        {"decision", plan_decision_names[static_cast<std::size_t>(entry.decision)]}, {"fact", entry.fact}};
  }
  return items;
}

}  // namespace marti::studies::run
