// How often a verdict on what limits a machine is right: of the old rule (the largest share of the nodes'
// time) and of the prediction for points of a sweep, against replays of machines with one resource made
// better.
//   bench_verdicts [SIZE [EVERY [MACHINES [CONFIG [wrong]]]]]     default: 128, 10, 500, configs/sweep.toml
// SIZE: of the image; EVERY: one of so many points of the sweep is measured; MACHINES: random ones; with
// `wrong` the wrong verdicts on the sweep are printed.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report.h"
#include "studies/figures/find_limit.h"
#include "studies/helps/verdict.h"
#include "studies/helps/what_helps.h"
#include "studies/keys/machine_keys.h"
#include "studies/limits/sweep_limits.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "tests/contract/random_cases.h"
#include "tests/support/configuration_of.h"
#include "tests/support/timed_sweep.h"

namespace {

using namespace marti;
using studies::helps::Help;
using studies::helps::WhatHelps;

double saved_by(const Help& help) { return help.step ? help.step->saved.value_or(0.0) : 0.0; }

// The parts whose improvement a finding of the old rule advises, as many as it can be taken to mean.
std::vector<studies::helps::Part> advised_by(studies::figures::Limit limit) {
  using studies::figures::Limit;
  using studies::helps::Part;
  switch (limit) {
    case Limit::compute:
      return {Part::nodes};
    case Limit::interconnect:
      return {Part::interconnect, Part::network};
    case Limit::bank:
      return {Part::banks, Part::local_memory};
    case Limit::memory_latency:
      return {Part::interconnect, Part::network, Part::banks,
              Part::local_memory, Part::caches,  Part::second_level};
    case Limit::dispatch:
      return {Part::host};
    case Limit::start_up:
    case Limit::lock:
      return {Part::building};
    case Limit::imbalance:
    case Limit::slowest_part:
      return {Part::regions};
    case Limit::write_buffer:
    case Limit::queues:
      return {Part::queues};
    case Limit::messages:
      return {Part::messages, Part::network};
    case Limit::nothing:
      break;
  }
  return {};
}

// What a step is worth: its share of the frame, or with prices as studies/helps has it.
std::pair<int, double> value_of(const Help& help, bool by_worth) {
  return by_worth ? studies::helps::worth(help) : std::pair(0, saved_by(help));
}

// The best of the steps that the old rule can be taken to advise; null if it advises none.
const Help* best_advised(studies::figures::Limit limit, const WhatHelps& what, bool by_worth) {
  const std::vector<studies::helps::Part> parts = advised_by(limit);
  const Help* best = nullptr;
  for (const Help& help : what.helps) {
    const bool packets = help.name.starts_with("packets.");
    const bool stage = help.name.starts_with("pipeline.") && help.part == studies::helps::Part::nodes;
    const bool of_part = std::find(parts.begin(), parts.end(), help.part) != parts.end() && !packets;
    const bool uneven = (limit == studies::figures::Limit::imbalance && packets) ||
                        (limit == studies::figures::Limit::slowest_part && stage);
    if (help.step && (of_part || uneven) &&
        (best == nullptr || value_of(help, by_worth) > value_of(*best, by_worth))) {
      best = &help;
    }
  }
  return best;
}

struct Score {
  std::size_t points = 0;
  std::size_t right = 0;  // gains at least as much as the best, less a tie
  std::size_t same = 0;   // names it
  std::vector<double> regrets;

  // A verdict: the step that it names, or null. `by_worth`: prices count.
  void add(const WhatHelps& what, const Help* named, bool by_worth) {
    const Help* best = nullptr;
    const auto value = [&](const Help& help) { return value_of(help, by_worth); };
    for (const Help& help : what.helps) {
      if (help.step && saved_by(help) >= studies::helps::worth_naming &&
          (best == nullptr || value(help) > value(*best))) {
        best = &help;
      }
    }
    const double gain = named != nullptr ? saved_by(*named) : 0.0;
    bool good = best == nullptr ? gain >= -studies::helps::tie : named == best;
    if (best != nullptr && named != nullptr) {
      const double price = by_worth ? named->step->price.value_or(0.0) : 0.0;
      good = good || studies::helps::worth(gain + studies::helps::tie, price) >= value(*best);
      if (!by_worth) {
        good = saved_by(*best) - gain <= studies::helps::tie;
      }
    }
    ++points;
    right += good ? 1 : 0;
    same += named == best ? 1 : 0;
    regrets.push_back(std::max(0.0, (best != nullptr ? saved_by(*best) : 0.0) - gain));
  }
  [[nodiscard]] double share(std::size_t count) const {
    return points > 0 ? static_cast<double>(count) / static_cast<double>(points) : 0.0;
  }
  void print(const char* name, bool with_regret) const {
    std::printf("%-34s right %5zu of %zu (%.1f %%), same name %.1f %%", name, right, points,
                100.0 * share(right), 100.0 * share(same));
    if (with_regret && points > 0) {
      const double sum = std::accumulate(regrets.begin(), regrets.end(), 0.0);
      std::printf(", regret %.2f %% of the frame on average, %.1f %% at most",
                  100.0 * sum / static_cast<double>(points),
                  100.0 * *std::max_element(regrets.begin(), regrets.end()));
    }
    std::printf("\n");
  }
};

const Help* find(const WhatHelps& what, const studies::limits::PredictedStep* step) {
  for (const Help& help : what.helps) {
    if (step != nullptr && help.name == step->name) {
      return &help;
    }
  }
  return nullptr;
}

// With `verbose` each wrong verdict is printed.
void score_sweep(bench::Report& report, const std::string& file, const std::string& size, std::size_t every,
                 bool verbose) {
  test::TimedSweep sweep(sim::Config::from_file(studies::sweep::sweep_schema(), file,
                                                std::vector{"image.width=" + size, "image.height=" + size}));
  const studies::limits::SweepLimits limits = sweep.limits();
  const studies::limits::SweepLimits priced = sweep.limits(sweep.prices());
  const auto begin = std::chrono::steady_clock::now();
  std::vector<studies::limits::PointLimit> predicted;
  for (std::size_t i = 0; i < sweep.points(); ++i) {
    predicted.push_back(limits.at(i));
  }
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  Score old_rule;
  Score rule;
  Score old_priced;
  Score rule_priced;
  std::size_t open = 0;
  // In random order, so that no axis keeps its value.
  std::vector<std::size_t> order(predicted.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  test::Random random(1);
  for (std::size_t i = order.size(); i > 1; --i) {
    std::swap(order[i - 1], order[random() % i]);
  }
  order.resize((order.size() + every - 1) / every);
  for (const std::size_t i : order) {
    const WhatHelps what = sweep.measure(i, sweep.prices().value_or(studies::keys::Prices{}));
    const studies::figures::Limit limit = studies::figures::find_limit(sweep.machine(i), sweep.result(i));
    const Help* const named = find(what, predicted[i].best());
    const std::size_t right = rule.right;
    old_rule.add(what, best_advised(limit, what, false), false);
    rule.add(what, named, false);
    open += predicted[i].open().empty() ? 0 : 1;
    if (verbose && rule.right == right) {
      std::printf("point %zu: %s\n  measured: %s\n", i, predicted[i].sentence().c_str(),
                  what.sentence.c_str());
    }
    if (sweep.prices()) {
      old_priced.add(what, best_advised(limit, what, true), true);
      rule_priced.add(what, find(what, priced.at(i).best()), true);
    }
  }
  std::printf("%s at %s x %s: %zu of %zu points\n", file.c_str(), size.c_str(), size.c_str(), rule.points,
              predicted.size());
  old_rule.print("largest share of time", true);
  rule.print("prediction", true);
  if (sweep.prices()) {
    old_priced.print("largest share of time, by price", false);
    rule_priced.print("prediction, by price", false);
  }
  std::printf("%zu verdicts are open; a prediction takes %.2f ms\n", open,
              1e3 * took.count() / static_cast<double>(predicted.size()));
  report.add(
      {.name = "right verdicts on a sweep, old rule", .unit = "1", .ours = old_rule.share(old_rule.right)});
  report.add({.name = "right verdicts on a sweep",
              .unit = "1",
              .ours = rule.share(rule.right),
              .aim = bench::Aim{0.95, true}});
}

void score_random(bench::Report& report, std::size_t machines) {
  using Maker = test::TimedCase (*)(test::Random&);
  constexpr std::array<Maker, 5> makers = {test::image_case, test::contexts_case, test::building_case,
                                           test::pipeline_case, test::space_case};
  Score old_rule;
  std::size_t advice = 0;
  std::size_t longer = 0;
  for (std::size_t seed = 0; seed < machines; ++seed) {
    test::Random random(seed);
    test::TimedCase made = makers[seed % makers.size()](random);
    test::use_default_interleave(made.machine);
    const std::vector<std::string> assignments = test::assignments_of(made.machine);
    sim::Config config = test::configuration_of(assignments);
    const processors::machine::MachineConfig machine = studies::keys::read_machine(config);
    const processors::replay::MachineResult result = processors::replay::replay(made.log, machine);
    if (result.end == 0) {
      continue;
    }
    const WhatHelps what =
        studies::helps::what_helps(config, std::nullopt, machine, result, {made.log, nullptr, {}, {}});
    old_rule.add(what, best_advised(studies::figures::find_limit(machine, result), what, false), false);
    const std::vector<const Help*> best = studies::helps::best_helps(what);
    if (!best.empty()) {
      std::vector<std::string> followed = assignments;
      for (const studies::helps::KeyChange& key : best[0]->step->keys) {
        followed.push_back(key.key + "=" + key.to);
      }
      sim::Config changed = test::configuration_of(followed);
      ++advice;
      longer += processors::replay::replay(made.log, studies::keys::read_machine(changed)).end >= result.end
                    ? 1
                    : 0;
    }
  }
  std::printf("%zu random machines of all schemes\n", old_rule.points);
  old_rule.print("largest share of time", true);
  std::printf("measured advice made the frame longer or no shorter on %zu of %zu\n", longer, advice);
  report.add({.name = "right verdicts on random machines, old rule",
              .unit = "1",
              .ours = old_rule.share(old_rule.right)});
  report.add({.name = "measured advice that made the frame no shorter",
              .unit = "machines",
              .ours = static_cast<double>(longer),
              .aim = bench::Aim{0.0, false}});
}

std::size_t number(const char* text, std::size_t least) {
  return std::max(least, static_cast<std::size_t>(std::max(0, std::atoi(text))));
}

}  // namespace

int main(int argc, char** argv) {
  return bench::run_benchmark(
      "bench_verdicts", argc, argv, [](bench::Report& report, int count, char** values) {
        const bool verbose = count > 5 && std::string_view(values[5]) == "wrong";
        score_sweep(report, count > 4 ? values[4] : "configs/sweep.toml", count > 1 ? values[1] : "128",
                    count > 2 ? number(values[2], 1) : 10, verbose);
        score_random(report, count > 3 ? number(values[3], 0) : 500);
      });
}
