// Cases of order and of sums: simultaneous events, and statistics of a thousand million samples.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "sim/engine.h"
#include "sim/error.h"
#include "sim/statistics.h"
#include "studies/stability/hostile.h"
#include "studies/stability/machines.h"

namespace marti::studies::stability {

namespace {

/// Notes the events it is handed.
class Notes final : public sim::EventHandler {
 public:
  void handle(const sim::Event& event) override { order.emplace_back(event.time, event.order); }
  std::vector<std::pair<sim::Ticks, std::uint64_t>> order;
};

/// Hands every event straight back.
class Endless final : public sim::EventHandler {
 public:
  explicit Endless(sim::Engine& engine) : engine_(engine) {}
  void handle(const sim::Event& event) override { engine_.post(event); }

 private:
  sim::Engine& engine_;
};

CaseOutcome orders_of_posting() {
  Random random(91);
  std::vector<sim::Event> events;
  for (std::uint32_t k = 0; k < 2000; ++k) {
    events.push_back(
        sim::Event::make(random.below(20), static_cast<std::uint8_t>(random.below(3)), random.below(50), k));
  }
  std::vector<sim::Event> sorted = events;
  std::ranges::sort(sorted, std::less<>());
  Tally tally;
  std::mt19937_64 engine(92);
  for (int order = 0; order < 100; ++order) {
    std::ranges::shuffle(events, engine);
    sim::Engine kernel;
    Notes notes;
    for (std::uint8_t c = 0; c < 3; ++c) {
      kernel.attach(c, notes);
    }
    for (const sim::Event& event : events) {
      kernel.post(event);
    }
    kernel.run(events.size());
    bool same = notes.order.size() == sorted.size();
    for (std::size_t k = 0; same && k < sorted.size(); ++k) {
      same = notes.order[k] == std::pair(sorted[k].time, sorted[k].order);
    }
    tally.add(same);
  }
  return none_wrong(tally, "orders differ");
}

CaseOutcome orders_of_starting() {
  Tally tally;
  for (const NamedTiming& one : machines_of_every_kind()) {
    const processors::replay::MachineResult base = processors::replay::replay(small_log(), one.machine);
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      processors::replay::ReplayOptions options;
      options.start_seed = seed;
      tally.add(is_stretched(base, processors::replay::replay(small_log(), one.machine, options), 1));
    }
  }
  return none_wrong(tally, "frames differ");
}

CaseOutcome step_by_step() {
  Tally tally;
  for (const NamedTiming& one : machines_of_every_kind()) {
    if (one.machine.scheme != processors::machine::Scheme::image) {
      continue;
    }
    processors::replay::MachineResult ahead = processors::replay::replay(small_log(), one.machine);
    processors::replay::ReplayOptions options;
    options.step_by_step = true;
    const processors::replay::MachineResult steps =
        processors::replay::replay(small_log(), one.machine, options);
    ahead.events = steps.events;  // the one thing that may differ
    tally.add(is_stretched(ahead, steps, 1));
  }
  return none_wrong(tally, "machines differ");
}

template <class Call>
bool is_our_fault(const Call& call) {
  try {
    call();
  } catch (const sim::InternalError&) {
    return true;
  }
  return false;
}

CaseOutcome no_progress() {
  Tally tally;
  tally.add(is_our_fault([] {
    sim::Engine engine;
    Endless endless(engine);
    engine.attach(0, endless);
    engine.post(sim::Event::make(5, 0, 1));
    engine.run(1000);
  }));
  tally.add(is_our_fault([] {
    sim::Engine engine;
    Notes notes;
    engine.attach(0, notes);
    engine.post(sim::Event::make(5, 0, 1));
    engine.run(1000);
    engine.post(sim::Event::make(4, 0, 1));  // the past
  }));
  return none_wrong(tally, "went unnoticed");
}

/// base + {0 .. 9}, each as often: the variance is 8.25.
CaseOutcome moments_at(std::int64_t base) {
  sim::Moments block;
  for (int k = 0; k < 1'000'000; ++k) {
    block.add(base + k % 10);
  }
  sim::Moments all;
  for (int k = 0; k < 1000; ++k) {
    all.merge(block);
  }
  const double mean = static_cast<double>(base) + 4.5;
  // Sums, here and below, because the larger of a number and NaN may be the number.
  const double error = std::abs(*all.variance() / 8.25 - 1.0) + std::abs(*all.mean() / mean - 1.0);
  CaseOutcome outcome = error_within(error, 1e-15, "relative error of mean and variance");
  outcome.figure += fmt::format("; {} samples", tables::grouped(static_cast<std::uint64_t>(all.count())));
  return outcome;
}

CaseOutcome moments_of_extremes() {
  sim::Moments moments;
  for (int k = 0; k < 1000; ++k) {
    moments.add(std::numeric_limits<std::int64_t>::max());
    moments.add(-std::numeric_limits<std::int64_t>::max());
  }
  const double largest = std::ldexp(1.0, 63);
  const double error = std::abs(*moments.variance() / (largest * largest) - 1.0) + std::abs(*moments.mean());
  return error_within(error, 1e-15, "relative error of the variance");
}

CaseOutcome orders_of_merging() {
  Random random(93);
  std::vector<sim::Moments> parts(64);
  sim::Moments together;
  for (std::size_t k = 0; k < 100'000; ++k) {
    const auto sample = static_cast<std::int64_t>(random.below(1'000'000)) - 300'000;
    parts[k % parts.size()].add(sample * 1'000'000'007);
    together.add(sample * 1'000'000'007);
  }
  Tally tally;
  std::mt19937_64 engine(94);
  for (int order = 0; order < 100; ++order) {
    std::ranges::shuffle(parts, engine);
    std::vector<sim::Moments> left = parts;
    while (left.size() > 1) {  // any two at a time
      const std::size_t a = engine() % left.size();
      const sim::Moments taken = left[a];
      left.erase(left.begin() + static_cast<std::ptrdiff_t>(a));
      left[engine() % left.size()].merge(taken);
    }
    tally.add(left[0] == together);
  }
  return none_wrong(tally, "orders differ");
}

CaseOutcome full_counters() {
  Tally tally;
  tally.add(is_our_fault([] {
    memory::WaitStatistics a;
    a.count = std::numeric_limits<std::int64_t>::max();
    memory::WaitStatistics b;
    b.count = 1;
    sim::merge(a, b);
  }));
  tally.add(is_our_fault([] {
    sim::Moments moments;
    moments.add(std::numeric_limits<std::int64_t>::max());
    moments.add(1);
    (void)moments.sum();
  }));
  return none_wrong(tally, "wrapped");
}

}  // namespace

void add_order_cases(std::vector<StabilityCase>& cases) {
  const CaseAdder add(cases, CaseGroup::machine);
  add("orders-of-posting", "2,000 events at 20 instants posted in 100 orders", "a sorted list",
      orders_of_posting);
  add("orders-of-starting", "the nodes' first events posted in other orders",
      "every time and count is the same", orders_of_starting);
  add("step-by-step", "nodes that run ahead through their hits",
      "an event for every reference: the same times", step_by_step);
  add("no-progress", "a loop of events at one instant, or an event in the past", "stopped as a fault of ours",
      no_progress);
  add("moments-1e6", "mean and variance of 1e9 samples near 1e6 cancel", "8.25, exact",
      [] { return moments_at(1'000'000); });
  add("moments-1e12", "mean and variance of 1e9 samples near 1e12 cancel", "8.25, exact",
      [] { return moments_at(1'000'000'000'000); });
  add("moments-extremes", "squares of samples near 2^63 overflow", "2^126, exact", moments_of_extremes);
  add("orders-of-merging", "sums of threads merged in other orders", "one sum, bit for bit",
      orders_of_merging);
  add("full-counters", "a counter or sum beyond 2^63 wraps", "stopped as a fault of ours", full_counters);
}

}  // namespace marti::studies::stability
