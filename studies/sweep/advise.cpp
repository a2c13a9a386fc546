#include "studies/sweep/advise.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "processors/replay/replay.h"
#include "processors/walk/stripped_log.h"
#include "sim/joined.h"
#include "sim/mapped.h"
#include "studies/figures/best_offer.h"
#include "studies/helps/what_helps.h"
#include "studies/host/signals_held.h"
#include "studies/keys/machine_keys.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/work/advice_work.h"

namespace marti::studies::sweep {

namespace {

constexpr std::size_t most_advised = 12;
constexpr helps::Work replays_of_one = 16;  // that a machine's advice should have, at least

// Of the replays of a sweep, whose machines share stripped logs. Found by timing 1,000 machines of
// configs/sweep.toml; helps::whole_replay_work is that of a replay by itself.
constexpr helps::Work sweep_reference = 2;
constexpr helps::Work sweep_event = 25;

// Whether two frames were rendered alike: trees that were built otherwise give the same rays and pixels.
bool is_same_work(const FrameRow& a, const FrameRow& b) {
  return a.scene_hash == b.scene_hash && a.image_hash == b.image_hash && a.hit_hash == b.hit_hash;
}

// Machines of the fastest point's frame that no other beats in price and time, the fastest first, then the
// knee. The price is the number of nodes where all points cost the same, as on the sweep's page.
std::vector<std::size_t> machines_that_matter(const SweepPlan& plan, SweepStore& store) {
  const std::vector<std::int64_t> ends = store.sums("\"end\"");
  const std::vector<std::int64_t> nodes = store.sums("nodes");
  const auto end_of = [&](const SweepPoint& point) { return ends[point.machine]; };
  const bool priced = std::ranges::any_of(
      plan.points, [&](const SweepPoint& point) { return point.cost != plan.points.front().cost; });
  const std::size_t frame = plan.machines[std::ranges::min_element(plan.points, {}, end_of)->machine].frame;
  std::vector<bool> compared;
  for (std::size_t other = 0; other < plan.frames.size(); ++other) {
    compared.push_back(is_same_work(*store.find_frame(frame), *store.find_frame(other)));
  }
  std::vector<figures::Offer> offers;
  std::vector<std::size_t> machines;
  for (const SweepPoint& point : plan.points) {
    if (compared[plan.machines[point.machine].frame]) {
      offers.push_back({priced ? point.cost : static_cast<double>(nodes[point.machine]),
                        static_cast<double>(end_of(point))});
      machines.push_back(point.machine);
    }
  }
  std::vector<std::size_t> front = figures::pareto_front(offers, figures::Better::lower);
  const std::vector<figures::Offer> on_front = sim::mapped(front, [&](std::size_t i) { return offers[i]; });
  const std::size_t knee = front[figures::knee_of(on_front)];
  std::ranges::reverse(front);
  if (const auto at = std::ranges::find(front, knee); at != front.begin()) {
    std::rotate(front.begin() + 1, at, at + 1);
  }
  return sim::mapped(front, [&](std::size_t i) { return machines[i]; });
}

sim::Config config_of(const SweepPlan& plan, const SweepMachine& machine, const sim::Schema& schema) {
  std::vector<std::string> given;
  const auto add = [&](const std::vector<sim::EffectiveValue>& settings) {
    for (const sim::EffectiveValue& setting : settings) {
      if (setting.given) {
        given.push_back(setting.key + "=" + setting.value);
      }
    }
  };
  add(plan.frames[machine.frame].settings);
  add(all_of(machine.settings));
  return sim::Config::from_text(schema, "", plan.file, given);
}

Advice measure(const SweepPlan& plan, const SweepMachine& machine, const processors::program::WorkLog& log,
               const sim::MemoryBudget& memory, helps::Work budget) {
  const sim::Schema& schema = sweep_schema();
  sim::Config config = config_of(plan, machine, schema);
  const processors::machine::MachineConfig described = keys::read_machine(config);
  helps::SharedLog shared{log, nullptr, {}, memory};
  if (processors::walk::StrippedLog::ways_of(described) != 0) {
    shared.stripped = processors::walk::StrippedLog::make(log, described, memory.left() / 4);
  }
  processors::replay::ReplayOptions options;
  options.stripped = shared.stripped.get();
  const processors::replay::MachineResult timed = processors::replay::replay(log, described, options);
  const helps::WhatHelps what = helps::what_helps(config, plan.prices, described, timed, shared, budget);
  const std::optional<double> noise =
      what.noise ? std::optional(helps::band_of(*what.noise, what.end)) : std::nullopt;
  const std::vector<const helps::Help*> best = helps::best_helps(what);
  const helps::MeasuredChange* const step = !best.empty() ? &*best.front()->step
                                            : what.pair   ? &what.pair->step
                                                          : nullptr;
  if (step == nullptr) {
    return {what.sentence, {}, {}, noise};
  }
  const std::vector<std::string> settings =
      sim::mapped(step->keys, [](const helps::KeyChange& key) { return key.key + "=" + key.to; });
  return {what.sentence, sim::joined(settings, "; "), step->saved, noise};
}

}  // namespace

void advise(const SweepPlan& plan, SweepStore& store, const sim::MemoryBudget& memory,
            const std::function<FrameLog(std::size_t)>& trace,
            const std::function<void(std::size_t, const Advice&)>& save) {
  if (plan.points.empty()) {
    return;
  }
  // A signal's last words close the store, which must not happen while it is read here.
  std::optional<host::SignalsHeld> held(std::in_place);
  std::vector<std::size_t> machines = machines_that_matter(plan, store);
  const std::vector<std::int64_t> references = store.sums("COALESCE(hits, 0) + COALESCE(misses, 0)");
  const std::vector<std::int64_t> events = store.sums("events");
  helps::Work of_sweep = 0;
  std::vector<helps::Work> alone;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto touched = static_cast<helps::Work>(references[i]);
    const auto happened = static_cast<helps::Work>(events[i]);
    of_sweep += sweep_reference * touched + sweep_event * happened;
    alone.push_back(helps::whole_replay_work(touched, happened));
  }
  const helps::Work budget = of_sweep / advice_part_of_sweep;
  const helps::Work enough = std::max(least_advice_work, replays_of_one * alone[machines.front()]);
  machines.resize(
      std::min(machines.size(), std::clamp<std::size_t>(budget / enough, least_advised, most_advised)));
  const helps::Work of_each = std::max(least_advice_work, budget / machines.size());
  const std::vector<bool> advised = store.advised();
  held.reset();
  for (const std::size_t index : machines) {
    if (advised[index]) {
      continue;
    }
    if (alone[index] > of_each) {  // the machine itself is replayed once more, too
      save(index, {"not measured: replays of this machine take long; `marti run --what-helps` measures it",
                   {},
                   {},
                   {}});
      continue;
    }
    const SweepMachine& machine = plan.machines[index];
    const FrameLog frame = trace(machine.frame);
    const std::uint64_t bytes = std::min(memory.left(), memory_of(*frame.log));
    save(index, measure(plan, machine, *frame.log, sim::MemoryBudget(memory.left() - bytes), of_each));
  }
}

}  // namespace marti::studies::sweep
