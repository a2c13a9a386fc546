// What would make a machine's frame shorter, and by how much: measured by replays of changed machines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "studies/helps/change.h"
#include "studies/helps/noise.h"
#include "studies/helps/replays.h"
#include "studies/helps/resources.h"
#include "studies/keys/price_keys.h"

namespace marti::studies::helps {

/// A gain of this share of the frame is worth naming.
inline constexpr double worth_naming = 0.005;
/// The most resources that a summary names.
inline constexpr std::size_t most_named = 3;
/// Gains that differ by at most so much are equal.
inline constexpr double tie = 0.001;

/// How much is measured.
enum class Measuring : std::uint8_t {
  none,
  within_budget,  ///< as much work as the run itself takes, or two seconds if that is more
  all
};

/// Whether a change was replayed, and if not, why.
enum class Outcome : std::uint8_t {
  measured,
  needless,   ///< it cannot be among the three best, or a resource at its best is not asked for
  work,       ///< it would take more work than the budget has
  memory,     ///< it would take too much memory
  uncounted,  ///< its frame takes longer than can be counted
};

/// A changed machine and its frame.
struct MeasuredChange {
  std::vector<KeyChange> keys;
  Outcome outcome = Outcome::needless;
  std::optional<sim::Ticks> end{};  ///< only of a change that was measured
  std::optional<double> saved{};    ///< share of the frame time that is saved; negative: the frame is longer
  double most_saved = 1.0;          ///< by the nodes' own work; no replay could give more
  /// What a faster clock saves of all the time, which is no less than of a part of it; std::nullopt: of what
  /// is no clock.
  std::optional<double> in_proportion{};
  std::optional<double> price{};  ///< by which the machine's price rises; std::nullopt: no prices are given
};

/// One resource (studies/helps/resources.h).
struct Help {
  std::string name;
  Part part = Part::nodes;
  std::optional<MeasuredChange> step;
  std::optional<MeasuredChange> best;
};

/// Two steps at once.
struct HelpPair {
  std::string first;
  std::string second;
  MeasuredChange step;
};

struct WhatHelps {
  sim::Ticks end = 0;    ///< frame time of the unchanged machine
  bool measured = true;  ///< false: the budget is too small for a single replay
  /// Of other orders of packets, within a tenth of the budget; empty: not measured.
  std::optional<OrderNoise> noise;
  /// Those worth most first: by the share of the frame that the step saves. With prices, behind the steps
  /// that raise no price, the others by that share for each unit of the price. Behind them those whose step
  /// was not replayed or does not help.
  std::vector<Help> helps;
  std::optional<HelpPair> pair;  ///< only where no step alone is worth naming and this pair is
  std::string sentence;          ///< for people: what to change, what that gives, and why
};

/// Measures what helps the machine of `config`, which was timed on the work log with `result`, by replays
/// that take about `budget` together.
[[nodiscard]] WhatHelps what_helps(const sim::Config& config, const std::optional<keys::Prices>& prices,
                                   const processors::machine::MachineConfig& machine,
                                   const processors::replay::MachineResult& result, const SharedLog& shared,
                                   Work budget = unlimited_work);

/// Whether a step saves less than another order of packets may; false where that is unknown.
[[nodiscard]] bool within_noise(const WhatHelps& what, const MeasuredChange& change);
/// What makes a step's saving doubtful, in brackets and after a space: that another order of packets does as
/// much, or that it is more than a clock can save by itself. Empty: nothing.
[[nodiscard]] std::string doubt_text(const WhatHelps& what, const MeasuredChange& change);

/// How much faster the machine gets: the frame time before, divided by that after, minus 1. std::nullopt for
/// a change that was not replayed, or whose frame takes no time.
[[nodiscard]] std::optional<double> gain_of(const WhatHelps& what, const MeasuredChange& change);

/// The steps that were not replayed.
struct Unreplayed {
  std::size_t needless = 0;  ///< they cannot be among the three best
  double most_saved = 0.0;   ///< the most that one of these can save
  std::size_t work = 0;      ///< they would take too much work
  std::size_t memory = 0;    ///< they would take too much memory
};
[[nodiscard]] Unreplayed unreplayed(const WhatHelps& what);

/// The helps that are named: at most three, each with a step that is worth naming.
[[nodiscard]] std::vector<const Help*> best_helps(const WhatHelps& what);
/// Whether the sentence names it beside the first of best_helps(), because it is worth as much.
[[nodiscard]] bool ties_with(const Help& first, const Help& help);

/// "machine.nodes 16 -> 32: frame 49.1 % shorter (at its best, machine.nodes 16 -> 4096: 78.3 %)"; with
/// prices also ", price +2", ", without a price" where none is given for what changes, or ", costs nothing"
/// where no part of the machine changes, as with smaller packets.
[[nodiscard]] std::string gain_text(const Help& help);

}  // namespace marti::studies::helps
