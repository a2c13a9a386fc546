#include "studies/explore/explored_machines.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "sim/joined.h"
#include "sim/mapped.h"
#include "studies/figures/derived_figures.h"

namespace marti::studies::explore {

namespace {

constexpr std::array<std::string_view, 7> shown_figures = {
    "end", "nodes", "speed_up", "efficiency", "hit_ratio", "interconnect_utilisation", "bank_utilisation"};

std::string name_of(Settings settings) {
  std::ranges::sort(settings);
  return settings.empty() ? "as the configuration"
                          : sim::joined(sim::mapped(settings, [](const auto& setting) {
                              return setting.first + " = " + setting.second;
                            }));
}

}  // namespace

void ExploredMachines::add(const Settings& settings, const run::RunResult& result) {
  Machine machine{name_of(settings), {}};
  for (const std::string_view figure : shown_figures) {
    machine.figures.push_back(result.figure(figure));
  }
  const std::lock_guard lock(mutex_);
  const bool known =
      std::ranges::any_of(machines_, [&](const Machine& other) { return other.name == machine.name; });
  if (!known && machines_.size() < most) {
    machines_.push_back(std::move(machine));
  }
}

tables::Table ExploredMachines::table() const {
  std::vector<tables::Column> columns = {
      tables::text_column("settings", "what differs from the configuration")};
  for (const std::string_view name : shown_figures) {
    const figures::FigureEntry& figure = figures::figure_named(name);
    columns.push_back(tables::real_column(figure.name, figure.unit, figure.description));
  }
  tables::Table table("explored", "All machines that were simulated", std::move(columns));
  const std::lock_guard lock(mutex_);
  for (const Machine& machine : machines_) {
    std::vector<tables::Cell> row = {machine.name};
    row.insert(row.end(), machine.figures.begin(), machine.figures.end());
    table.add_row(std::move(row));
  }
  return table;
}

}  // namespace marti::studies::explore
