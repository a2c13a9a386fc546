// The derived figures of a timed machine: ratios of counted ones, never stored. They are columns of the view
// `summary` of a sweep's store, and fields of `figures.machine` in result.json.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "studies/figures/counted_figures.h"

namespace marti::studies::figures {

[[nodiscard]] std::span<const FigureEntry> derived_figures();

/// The parts of the lost speed-up. The derived figures "lost_" + name add up to the number of nodes less
/// speed_up times the nodes of the base: with one node as the base, to what is lost of the ideal speed-up.
inline constexpr std::array<std::string_view, 5> loss_names = {"extra_misses", "contention", "imbalance",
                                                               "overhead", "idle"};

/// A part of the lost speed-up for people: "extra misses".
[[nodiscard]] std::string loss_text(std::string_view loss);
/// Through what n nodes are faster than n times one, where this part is below 0: "less time for hits and
/// misses ...".
[[nodiscard]] std::string_view gain_of(std::string_view loss);

/// A machine's counts, and those of the machines that it is measured against, where they are known.
struct MeasuredCounts {
  const Counts* own = nullptr;
  const Counts* base = nullptr;
  const Counts* compared = nullptr;
};

/// The value of the counted or derived figure of this name; std::nullopt where the machine has no such part,
/// a denominator is 0, or the machine that it is measured against is unknown. Throws InternalError for an
/// unknown name.
[[nodiscard]] std::optional<double> figure_of(const MeasuredCounts& counts, std::string_view name);
/// Calls visit(name, value) for each derived figure that has a value.
template <class Visit>
void for_each_derived(const MeasuredCounts& counts, Visit&& visit) {
  for (const FigureEntry& entry : derived_figures()) {
    if (const std::optional<double> value = figure_of(counts, entry.name)) {
      visit(entry.name, *value);
    }
  }
}
/// Of a figure that is not measured against another machine.
[[nodiscard]] std::optional<double> figure_of(const processors::machine::MachineConfig& machine,
                                              const processors::replay::MachineResult& result,
                                              std::string_view name);

/// The entry of a counted or derived figure. Throws UserError for an unknown name, with the nearest known
/// one.
[[nodiscard]] const FigureEntry& figure_named(std::string_view name);
/// Throws UserError for a figure of which neither lower nor higher values are better, its message behind
/// `place`; for an unknown name as figure_named().
void require_direction(std::string_view name, std::string_view place = {});

}  // namespace marti::studies::figures
