// The plan of a sweep as text.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/tables/text_units.h"

namespace marti::studies::sweep {

namespace {

constexpr std::size_t most_steps_shown = 8;
constexpr std::size_t most_skipped_shown = 3;

// The first and the last ones of a long list.
std::string shorten(const std::vector<std::string>& steps) {
  if (steps.size() <= most_steps_shown) {
    return fmt::format("{}", fmt::join(steps, ", "));
  }
  const auto kept = static_cast<std::ptrdiff_t>(most_steps_shown) - 2;
  return fmt::format("{}, ..., {} ({} values)", fmt::join(steps.begin(), steps.begin() + kept, ", "),
                     steps.back(), steps.size());
}

std::string number(std::uint64_t count) { return tables::grouped(static_cast<std::int64_t>(count)); }

}  // namespace

std::string describe(const SweepPlan& plan, const SweepOutlook& outlook) {
  std::string text;
  const auto line = [&](std::string_view what, const std::string& says) {
    text += fmt::format("{:<14}{}\n", what, says);
  };
  for (const SweepDirection& direction : plan.directions) {
    line(&direction == plan.directions.data() ? "axes" : "",
         fmt::format("{}: {}", fmt::join(direction.keys, " and "), shorten(direction.steps)));
  }
  std::string points = number(plan.points.size());
  if (plan.filtered_out > 0) {
    points += fmt::format(", {} more do not pass the filter", number(plan.filtered_out));
  }
  if (!plan.skipped.empty()) {
    points += fmt::format(", {} more cannot be built", number(plan.skipped.size()));
  }
  line("points", points);
  for (std::size_t i = 0; i < std::min(most_skipped_shown, plan.skipped.size()); ++i) {
    line("", "left out: " + plan.skipped[i].point + ": " + plan.skipped[i].reason);
  }
  line("frames", fmt::format("{}, {} done", tables::counted(plan.frames.size(), "functional run"),
                             number(outlook.frames_done)));

  std::vector<bool> asked_for(plan.machines.size());
  for (const SweepPoint& point : plan.points) {
    asked_for[point.machine] = true;
  }
  const auto of_points = static_cast<std::size_t>(std::ranges::count(asked_for, true));
  std::string machines = number(plan.machines.size());
  if (of_points < plan.machines.size()) {
    machines += fmt::format(" ({} of points, {} to measure them against)", number(of_points),
                            number(plan.machines.size() - of_points));
  }
  std::set<std::size_t> replays;
  for (const SweepMachine& machine : plan.machines) {
    replays.insert(machine.timing);
  }
  if (replays.size() < plan.machines.size()) {
    machines += fmt::format(" in {} replays", number(replays.size()));
  }
  line("machines", machines + fmt::format(", {} done", number(outlook.machines_done)));

  const auto by_cost = [](const SweepPoint& a, const SweepPoint& b) { return a.cost < b.cost; };
  const auto [cheapest, dearest] = std::minmax_element(plan.points.begin(), plan.points.end(), by_cost);
  if (cheapest != plan.points.end()) {
    line("price", fmt::format("{:.6g} to {:.6g} a machine", cheapest->cost, dearest->cost));
  }
  constexpr double worth_a_word = 1 << 20;
  const auto itself = static_cast<double>(plan_bytes(plan.points.size(), plan.axes.size()));
  if (outlook.machine_bytes > 0 || itself >= worth_a_word) {
    line("memory", fmt::format("about {} for the machines that are timed at once{}",
                               tables::bytes(static_cast<double>(outlook.machine_bytes)),
                               itself >= worth_a_word ? ", " + tables::bytes(itself) + " for the plan"
                                                      : std::string()));
  }
  for (const std::string& note : plan.notes) {
    line("note", note);
  }
  return text;
}

}  // namespace marti::studies::sweep
