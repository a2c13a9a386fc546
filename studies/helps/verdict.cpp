#include "studies/helps/verdict.h"

#include <fmt/format.h>

#include <algorithm>

namespace marti::studies::helps {

namespace {

double saved(const Help& help) { return help.step ? help.step->saved.value_or(0.0) : 0.0; }

bool named(const Help& help) { return saved(help) >= worth_naming; }

// The step's price; 0 for one that has none.
double price(const Help& help) { return help.step ? help.step->price.value_or(0.0) : 0.0; }

// Whether a step only divides the program's work in another way, so that no part of the machine changes.
bool is_of_program(const MeasuredChange& step) {
  return std::ranges::all_of(step.keys, [](const KeyChange& change) {
    return change.key.starts_with("packets.") || change.key.starts_with("build.") ||
           change.key == "space.level";
  });
}

std::string price_text(const MeasuredChange& step) {
  if (!step.price) {
    return {};
  }
  if (*step.price != 0.0) {
    return fmt::format(", price {:+g}", *step.price);
  }
  return is_of_program(step) ? ", costs nothing" : ", without a price";
}

std::string percent(double share) { return fmt::format("{:.1f} %", 100.0 * share); }

// What the resource gives at its best, where that is more than the step gives.
std::string at_best(const Help& help) {
  return help.best && help.best->saved && *help.best->saved > saved(help)
             ? fmt::format(" (at its best, {}: {})", describe(help.best->keys), percent(*help.best->saved))
             : std::string();
}

// The other named resources that are worth as much as the first.
std::string ties(const std::vector<const Help*>& helps) {
  std::string text;
  for (std::size_t i = 1; i < helps.size(); ++i) {
    if (ties_with(*helps[0], *helps[i])) {
      text += fmt::format(", or {}: {}", describe(helps[i]->step->keys), percent(saved(*helps[i])));
    }
  }
  return text;
}

// Where no step helps: the resource that would help most if it cost nothing.
std::string nothing(const WhatHelps& what) {
  const Help* most = nullptr;
  for (const Help& help : what.helps) {
    const double now = help.best ? help.best->saved.value_or(0.0) : 0.0;
    if (now >= worth_naming && (most == nullptr || now > *most->best->saved)) {
      most = &help;
    }
  }
  const Unreplayed left = unreplayed(what);
  std::string text =
      fmt::format("no step alone{} makes the frame {} shorter",
                  left.work + left.memory > 0 ? " of those that were tried" : "", percent(worth_naming));
  if (most != nullptr) {
    text += fmt::format("; at its best, {} makes it {} shorter", describe(most->best->keys),
                        percent(*most->best->saved));
  }
  return text;
}

// Where not all steps could be tried, a better one may be among the others.
std::string tried(const WhatHelps& what) {
  const Unreplayed left = unreplayed(what);
  const std::size_t steps = what.helps.size();
  const std::size_t untried = left.work + left.memory;
  return untried == 0 ? std::string() : fmt::format("; {} of {} steps tried", steps - untried, steps);
}

}  // namespace

std::pair<int, double> worth(double saved, double price) {
  if (saved < worth_naming) {
    return {0, saved};
  }
  return price > 0.0 ? std::pair(1, saved / price) : std::pair(2, saved);
}

std::pair<int, double> worth(const Help& help) {
  const bool replayed = help.step && help.step->saved;
  return replayed ? worth(saved(help), price(help)) : std::pair(-1, 0.0);
}

bool ties_with(const Help& first, const Help& help) {
  return price(first) == price(help) && saved(first) - saved(help) <= tie;
}

bool within_noise(const WhatHelps& what, const MeasuredChange& change) {
  return what.noise && change.saved && *change.saved < band_of(*what.noise, what.end);
}

std::string doubt_text(const WhatHelps& what, const MeasuredChange& change) {
  if (within_noise(what, change)) {
    return fmt::format(" (no more than another order of packets, {:.2f} %)",
                       100.0 * band_of(*what.noise, what.end));
  }
  constexpr double rounding = 0.0005;
  if (change.in_proportion && change.saved && *change.saved > *change.in_proportion + rounding) {
    return fmt::format(" (more than the clock's {}: the rest is the packets' order)",
                       percent(*change.in_proportion));
  }
  return {};
}

std::optional<double> gain_of(const WhatHelps& what, const MeasuredChange& change) {
  return change.end && *change.end > 0
             ? std::optional(static_cast<double>(what.end) / static_cast<double>(*change.end) - 1.0)
             : std::nullopt;
}

Unreplayed unreplayed(const WhatHelps& what) {
  Unreplayed left;
  for (const Help& help : what.helps) {
    const MeasuredChange* const change = help.step ? &*help.step : help.best ? &*help.best : nullptr;
    if (change == nullptr) {
      continue;
    }
    switch (change->outcome) {
      case Outcome::needless:
        ++left.needless;
        left.most_saved = std::max(left.most_saved, change->most_saved);
        break;
      case Outcome::work:
        ++left.work;
        break;
      case Outcome::memory:
        ++left.memory;
        break;
      case Outcome::measured:
      case Outcome::uncounted:
        break;
    }
  }
  return left;
}

std::vector<const Help*> best_helps(const WhatHelps& what) {
  std::vector<const Help*> helps;
  for (const Help& help : what.helps) {
    if (helps.size() < most_named && named(help)) {
      helps.push_back(&help);
    }
  }
  return helps;
}

std::string gain_text(const Help& help) {
  return fmt::format("{}: frame {} shorter{}{}", describe(help.step->keys), percent(saved(help)),
                     at_best(help), price_text(*help.step));
}

std::string verdict(const WhatHelps& what, const processors::machine::MachineConfig& machine,
                    const processors::replay::MachineResult& result, const figures::Counts& counts) {
  if (result.end == 0) {
    return "nothing: the frame takes no time on this machine";
  }
  if (!what.measured) {
    return "not measured: replays of this machine take long; --what-helps measures it";
  }
  const std::vector<const Help*> helps = best_helps(what);
  if (!helps.empty()) {
    return fmt::format("{}{}{}; {}{}", gain_text(*helps[0]), doubt_text(what, *helps[0]->step), ties(helps),
                       why(*helps[0], machine, result, counts), tried(what));
  }
  if (what.pair) {
    return fmt::format(
        "{}: frame {} shorter; of {} and {} each alone saves less than {}, because the other stays full{}",
        describe(what.pair->step.keys), percent(*what.pair->step.saved), what.pair->first, what.pair->second,
        percent(worth_naming), tried(what));
  }
  return nothing(what) + tried(what);
}

}  // namespace marti::studies::helps
