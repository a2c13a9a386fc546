#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <string_view>

#include "studies/show/result_parts.h"
#include "studies/tables/text_units.h"

namespace marti::studies::show {

namespace {

using processors::energy::EnergyResult;

double in_joules(std::int64_t femtojoules) { return static_cast<double>(femtojoules) / 1e15; }

double share(std::int64_t part, const EnergyResult& energy) {
  return energy.total > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(energy.total) : 0.0;
}

}  // namespace

std::string energy_lines(const run::RunResult& result) {
  std::string text;
  if (!result.timed.energy) {
    return text;
  }
  const EnergyResult& energy = *result.timed.energy;
  constexpr auto counters = EnergyResult::counters();
  const auto* const end = counters.begin() + processors::energy::energy_parts;
  const auto* const largest = std::max_element(counters.begin(), end, [&](const auto& a, const auto& b) {
    return energy.*a.member < energy.*b.member;
  });
  const std::optional<double> power = result.figure("power");
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "\nenergy        {} a frame, {} W; its largest part is {} ({:.2f} %)\n",
                 tables::joules(in_joules(energy.total)), power ? fmt::format("{:.3g}", *power) : "-",
                 largest->name, share(energy.*largest->member, energy));
  for (const auto* part = counters.begin(); part != end; ++part) {
    if (energy.*part->member > 0) {
      fmt::format_to(out, "  {:<14}{:>12} {:>8.2f} %\n", part->name,
                     tables::joules(in_joules(energy.*part->member)), share(energy.*part->member, energy));
    }
  }
  fmt::format_to(out, "  {:.4g} rays a joule, {:.4g} uJ s, {:.4g} mm2 of nodes and caches\n",
                 result.figure("rays_a_joule").value_or(0.0), result.figure("energy_delay").value_or(0.0),
                 result.figure("area").value_or(0.0));
  return text;
}

}  // namespace marti::studies::show
