#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "sim/mapped.h"
#include "studies/figures/counted_figures.h"
#include "studies/helps/resources.h"
#include "studies/helps/verdict.h"
#include "studies/helps/what_helps.h"
#include "studies/helps/work.h"

namespace marti::studies::helps {

namespace {

// Pairs are tried among so many parts of the machine, those that would gain most if they cost nothing.
constexpr std::size_t most_in_pairs = 4;

// So many replays are begun together, on any number of cores. Which steps come next depends on them.
constexpr std::size_t begun_together = 4;

// The noise is measured with this part of the budget, beside it.
constexpr Work part_for_noise = 10;

// What the steps of a part have saved, by what was expected of them, tells of its other steps; within these
// bounds, because one bad guess must not rule out a part.
constexpr double least_trust = 0.25;
constexpr double most_trust = 4.0;

double saved_of(sim::Ticks before, sim::Ticks after) {
  return 1.0 - static_cast<double>(after) / static_cast<double>(before);
}

double saved_by(const std::optional<MeasuredChange>& change) {
  return change ? change->saved.value_or(0.0) : 0.0;
}

class Measurement {
 public:
  Measurement(const Changer& changer, const std::optional<keys::Prices>& prices,
              const processors::machine::MachineConfig& machine,
              const processors::replay::MachineResult& result, const figures::Counts& counts,
              const SharedLog& shared, Work budget)
      : changer_(changer),
        prices_(prices),
        machine_(machine),
        result_(result),
        shared_(shared),
        limited_(budget != unlimited_work),
        budget_(budget) {
    what_.end = result.end;
    const Work one = replay_work(result_, stripped_for(shared_, machine_));
    what_.measured = !limited_ || budget_ >= one;
    for (Resource& resource : resources_of(changer, machine, facts_of(result))) {
      Case& made = cases_.emplace_back();
      made.help = {resource.name, resource.part, unmeasured(resource.step, resource),
                   unmeasured(resource.best, resource)};
      made.expected = expected_saving(made.help, resource.factor, machine, result, counts);
      made.resource = std::move(resource);
    }
  }

  WhatHelps made() {
    if (!what_.measured) {
      for (Case* const one : unreplayed_cases()) {
        change_of(*one).outcome = Outcome::work;
      }
      take_helps();
      return std::move(what_);
    }
    what_.noise =
        measure_noise(shared_, machine_, result_, limited_ ? budget_ / part_for_noise : unlimited_work);
    measure_steps();
    std::ranges::stable_sort(cases_,
                             [&](const Case& a, const Case& b) { return worth(a.help) > worth(b.help); });
    take_helps();
    const std::size_t named = best_helps(what_).size();
    measure_best(named);
    if (named == 0) {
      find_pair();
    }
    take_helps();
    return std::move(what_);
  }

 private:
  struct Case {
    Resource resource;
    Help help;
    double expected = 0.0;  // share of the frame that the step may save, by a first guess
  };
  struct Replay {
    const processors::machine::MachineConfig* machine;
    MeasuredChange* into;
  };
  // What the steps of a part were expected to save, and what those that were replayed have saved.
  struct Trust {
    double expected = 0.0;
    double saved = 0.0;
  };

  // What measure_steps() replays of a case: its step. A case without a step has only the resource at its
  // best.
  static MeasuredChange& change_of(Case& one) { return one.help.step ? *one.help.step : *one.help.best; }
  static const Change& machine_of(const Case& one) {
    return one.resource.step ? *one.resource.step : *one.resource.best;
  }
  // Packets, which count as a part of the nodes, are one of their own.
  static std::pair<Part, bool> part_of(const Case& one) {
    return {one.help.part, one.help.name.starts_with("packets.")};
  }

  // What is known of a change without a replay.
  [[nodiscard]] std::optional<MeasuredChange> unmeasured(const std::optional<Change>& change,
                                                         const Resource& resource) const {
    if (!change) {
      return std::nullopt;
    }
    MeasuredChange measured;
    measured.keys = change->keys;
    if (resource.same_frame) {
      measured.outcome = Outcome::measured;
      measured.end = result_.end;
      measured.saved = measured.most_saved = 0.0;
    } else if (resource.same_work) {
      measured.most_saved = saved_of(result_.end, least_time(machine_, result_, change->machine));
    }
    if (measured.keys.size() == 1 && measured.keys.front().key.ends_with(".clock")) {
      measured.in_proportion = 1.0 - 1.0 / resource.factor;
    }
    if (prices_) {
      measured.price = keys::cost_of(*prices_, change->machine) - keys::cost_of(*prices_, machine_);
    }
    return measured;
  }

  // Whether there is room for a replay of so many bytes, and work left for one that is like the machine's
  // own.
  bool can_begin(const Replay& replay, std::uint64_t bytes, Work& begun) {
    if (bytes > shared_.memory.left()) {
      replay.into->outcome = Outcome::memory;
      return false;
    }
    const Work work = replay_work(result_, stripped_for(shared_, *replay.machine));
    if (limited_ && work + begun > budget_) {
      replay.into->outcome = Outcome::work;
      return false;
    }
    begun += work;
    return true;
  }

  void replay(const std::vector<Replay>& wanted) {
    Work begun = 0;
    std::uint64_t most_bytes = 0;
    std::vector<const processors::machine::MachineConfig*> machines;
    std::vector<MeasuredChange*> changes;
    for (const Replay& one : wanted) {
      const std::uint64_t bytes = bytes_of(shared_, *one.machine);
      if (can_begin(one, bytes, begun)) {
        most_bytes = std::max(most_bytes, bytes);
        machines.push_back(one.machine);
        changes.push_back(one.into);
      }
    }
    const std::vector<Replayed> replayed = replay_all(shared_, machines, most_bytes);
    for (std::size_t i = 0; i < replayed.size(); ++i) {
      MeasuredChange& change = *changes[i];
      change.end = replayed[i].end;
      change.outcome = replayed[i].end         ? Outcome::measured
                       : replayed[i].no_memory ? Outcome::memory
                                               : Outcome::uncounted;
      if (change.end) {
        change.saved = saved_of(result_.end, *change.end);
      }
      if (limited_) {
        budget_ -= std::min(budget_, replayed[i].work);
      }
    }
  }

  std::vector<Case*> unreplayed_cases() {
    std::vector<Case*> found;
    for (Case& one : cases_) {
      if (change_of(one).outcome != Outcome::measured) {
        found.push_back(&one);
      }
    }
    return found;
  }

  // The cases that are replayed next, those first that are expected to save most. While parts of the machine
  // have not had their turn, one of each comes before all others: what is busiest need not be what helps, as
  // where nodes of a pipeline are busy with waiting for a bus.
  std::vector<Case*> next_of(std::vector<Case*>& left) {
    std::map<std::pair<Part, bool>, Trust> trust;
    for (const Case& one : cases_) {
      if (one.help.step && one.help.step->saved && !one.resource.same_frame) {
        Trust& part = trust[part_of(one)];
        part.expected += one.expected;
        part.saved += std::max(0.0, *one.help.step->saved);
      }
    }
    const auto expected = [&](const Case* one) {
      const auto part = trust.find(part_of(*one));
      const bool told = part != trust.end() && part->second.expected > 0.0;
      return std::min(
          one->help.step ? one->help.step->most_saved : 1.0,
          one->expected *
              (told ? std::clamp(part->second.saved / part->second.expected, least_trust, most_trust) : 1.0));
    };
    std::ranges::stable_sort(left, std::greater<>(), expected);
    std::vector<Case*> turn;
    std::vector<Case*> later;
    for (Case* const one : left) {
      const bool waits = trust.contains(part_of(*one)) || std::ranges::any_of(turn, [&](const Case* other) {
                           return part_of(*other) == part_of(*one);
                         });
      (waits || expected(one) < worth_naming ? later : turn).push_back(one);
    }
    turn.insert(turn.end(), later.begin(), later.end());
    left = turn;
    turn.resize(std::min(turn.size(), begun_together));
    left.erase(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(turn.size()));
    return turn;
  }

  // What a step must be able to save to be worth a replay. With prices any that is worth naming may be the
  // advice, because a smaller gain may be the cheaper one.
  [[nodiscard]] double least_wanted() const {
    std::vector<double> saved = sim::mapped(cases_, [&](const Case& one) { return saved_by(one.help.step); });
    if (prices_ || saved.size() < most_named) {
      return worth_naming;
    }
    std::ranges::sort(saved, std::greater<>());
    return std::max(worth_naming, saved[most_named - 1]);
  }

  // So many machines are replayed next, at most.
  void tell(std::size_t machines) const {
    sim::begin_part(shared_.meter, "measuring what would help", "machines", machines);
  }

  void measure_steps() {
    std::vector<Case*> left = unreplayed_cases();
    tell(left.size());
    while (!left.empty()) {
      const double least = least_wanted();
      std::erase_if(left,
                    [&](Case* one) { return change_of(*one).most_saved < least; });  // it stays needless
      std::vector<Replay> together;
      for (Case* const one : next_of(left)) {
        together.push_back({&machine_of(*one).machine, &change_of(*one)});
      }
      replay(together);
    }
  }

  // What the named resources give at their best; if none is named, what all do.
  void measure_best(std::size_t named) {
    std::vector<Replay> replays;
    for (std::size_t i = 0; i < (named == 0 ? cases_.size() : named); ++i) {
      std::optional<MeasuredChange>& best = cases_[i].help.best;
      if (best && best->outcome == Outcome::needless && best->most_saved >= worth_naming) {
        replays.push_back({&cases_[i].resource.best->machine, &*best});
      }
    }
    tell(replays.size());
    replay(replays);
  }

  // The resources that would gain most if they cost nothing, one of each part: what binds together with a bus
  // is not another property of the bus.
  [[nodiscard]] std::vector<const Case*> best_of_parts() const {
    std::vector<const Case*> sorted;
    for (const Case& one : cases_) {
      if (one.help.step && one.help.step->end && one.help.best && one.help.best->end) {
        sorted.push_back(&one);
      }
    }
    std::ranges::stable_sort(
        sorted, [](const Case* a, const Case* b) { return saved_by(a->help.best) > saved_by(b->help.best); });
    std::vector<const Case*> best;
    for (const Case* const one : sorted) {
      const bool first =
          std::ranges::none_of(best, [&](const Case* other) { return other->help.part == one->help.part; });
      if (first && best.size() < most_in_pairs) {
        best.push_back(one);
      }
    }
    return best;
  }

  void find_pair() {
    const std::vector<const Case*> candidates = best_of_parts();
    std::vector<HelpPair> pairs;
    std::vector<Change> changes;
    std::vector<double> alone;  // what the two steps of a pair save, each for itself
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      for (std::size_t j = i + 1; j < candidates.size(); ++j) {
        const Resource& a = candidates[i]->resource;
        const Resource& b = candidates[j]->resource;
        if (std::optional<Change> both = changer_.both(*a.step, *b.step)) {
          // The nodes' own work bounds the pair only if both leave the steps' cycles as they are.
          Resource together;
          together.same_work = a.same_work && b.same_work;
          pairs.push_back({a.name, b.name, *unmeasured(both, together)});
          alone.push_back(std::max(0.0, saved_by(candidates[i]->help.step)) +
                          std::max(0.0, saved_by(candidates[j]->help.step)));
          changes.push_back(*std::move(both));
        }
      }
    }
    std::vector<Replay> replays;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      replays.push_back({&changes[i].machine, &pairs[i].step});
    }
    tell(replays.size());
    replay(replays);
    double most = 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double saved = pairs[i].step.saved.value_or(0.0);
      if (saved - alone[i] >= worth_naming && saved > most) {
        most = saved;
        what_.pair = pairs[i];
      }
    }
  }

  void take_helps() {
    what_.helps.clear();
    for (const Case& one : cases_) {
      what_.helps.push_back(one.help);
    }
  }

  const Changer& changer_;
  const std::optional<keys::Prices>& prices_;
  const processors::machine::MachineConfig& machine_;
  const processors::replay::MachineResult& result_;
  const SharedLog& shared_;
  bool limited_;
  Work budget_;  // what is left of it
  std::vector<Case> cases_;
  WhatHelps what_;
};

}  // namespace

WhatHelps what_helps(const sim::Config& config, const std::optional<keys::Prices>& prices,
                     const processors::machine::MachineConfig& machine,
                     const processors::replay::MachineResult& result, const SharedLog& shared, Work budget) {
  WhatHelps what;
  const figures::Counts counts = figures::counts_of(machine, result);
  if (result.end > 0) {
    const Changer changer(config);
    what = Measurement(changer, prices, machine, result, counts, shared, budget).made();
  }
  what.sentence = verdict(what, machine, result, counts);
  return what;
}

}  // namespace marti::studies::helps
