// What helps is measured: its promises are kept by the machines that it advises.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include "processors/replay/replay_parts.h"
#include "studies/figures/counted_figures.h"
#include "studies/helps/resources.h"
#include "studies/helps/verdict.h"
#include "studies/helps/what_helps.h"
#include "studies/helps/work.h"
#include "studies/keys/machine_keys.h"
#include "studies/run/run_result.h"
#include "tests/contract/random_cases.h"
#include "tests/support/configuration_of.h"
#include "tests/support/long_tests.h"

namespace marti::studies {

using namespace figures;
using namespace helps;
using namespace keys;
using namespace run;

namespace {

using processors::machine::MachineConfig;
using processors::replay::MachineResult;

MachineConfig machine_of(const std::vector<std::string>& assignments) {
  sim::Config config = test::configuration_of(assignments);
  return read_machine(config);
}

std::vector<std::string> with(std::vector<std::string> assignments, const std::vector<KeyChange>& keys) {
  for (const KeyChange& key : keys) {
    assignments.push_back(key.key + "=" + key.to);
  }
  return assignments;
}

// A configuration, its machine and frame, and what helps it.
struct Case {
  Case(const processors::program::WorkLog& work_log, std::vector<std::string> values,
       std::optional<Prices> prices = std::nullopt)
      : log(work_log),
        assignments(std::move(values)),
        config(test::configuration_of(assignments)),
        machine(read_machine(config)),
        result(processors::replay::replay(log, machine)),
        what(what_helps(config, prices, machine, result, {log, nullptr, {}, {}})) {}

  [[nodiscard]] sim::Ticks end_with(const std::vector<KeyChange>& keys) const {
    return processors::replay::replay(log, machine_of(with(assignments, keys))).end;
  }
  [[nodiscard]] const Help* find(std::string_view name) const {
    const auto found = std::find_if(what.helps.begin(), what.helps.end(),
                                    [&](const Help& help) { return help.name == name; });
    return found == what.helps.end() ? nullptr : &*found;
  }

  const processors::program::WorkLog& log;
  std::vector<std::string> assignments;
  sim::Config config;
  MachineConfig machine;
  MachineResult result;
  WhatHelps what;
};

double saved(const Case& one, sim::Ticks end) {
  return 1.0 - static_cast<double>(end) / static_cast<double>(one.result.end);
}

// A promise is kept by the machine that has these values by its configuration.
void expect_kept(const Case& one, const MeasuredChange& change) {
  ASSERT_FALSE(change.keys.empty());
  if (change.end) {
    EXPECT_EQ(one.end_with(change.keys), *change.end) << describe(change.keys);
    EXPECT_DOUBLE_EQ(*change.saved, saved(one, *change.end));
    EXPECT_LE(*change.saved, change.most_saved + 1e-12) << describe(change.keys);
  }
}

// Steps that were not replayed give no more than their bound, and none of them more than a step that is
// named.
void expect_rightly_left_out(const Case& one) {
  const std::vector<const Help*> named = best_helps(one.what);
  const double least = named.size() < 3 ? worth_naming : *named.back()->step->saved;
  for (const Help& help : one.what.helps) {
    if (help.step && help.step->outcome == Outcome::needless) {
      const double left = saved(one, one.end_with(help.step->keys));
      EXPECT_LE(left, help.step->most_saved + 1e-12) << describe(help.step->keys);
      EXPECT_LE(left, std::max(least, worth_naming)) << describe(help.step->keys);
    }
  }
}

// What is named was replayed and makes the frame shorter, by what is promised.
void expect_advice_followed(const Case& one, const WhatHelps& what) {
  for (const Help* help : best_helps(what)) {
    expect_kept(one, *help->step);
    EXPECT_LT(*help->step->end, one.result.end) << what.sentence;
    EXPECT_GE(*help->step->saved, worth_naming) << what.sentence;
  }
  if (what.pair) {
    expect_kept(one, what.pair->step);
    EXPECT_LT(*what.pair->step.end, one.result.end) << what.sentence;
  }
}

void expect_followed(const Case& one) {
  const std::vector<const Help*> named = best_helps(one.what);
  for (const Help& help : one.what.helps) {
    for (const std::optional<MeasuredChange>* change : {&help.step, &help.best}) {
      if (*change) {
        expect_kept(one, **change);
      }
    }
    if (help.step && help.step->saved && !named.empty()) {
      EXPECT_LE(*help.step->saved, *named[0]->step->saved);
    }
  }
  expect_advice_followed(one, one.what);
  EXPECT_TRUE(!one.what.pair || named.empty()) << one.what.sentence;
  expect_rightly_left_out(one);
}

using Maker = test::TimedCase (*)(test::Random&);
constexpr std::array<Maker, 5> makers = {test::image_case, test::contexts_case, test::building_case,
                                         test::pipeline_case, test::space_case};

TEST(WhatHelps, KeepsItsPromisesOnMachinesOfEveryKind) {
  const std::size_t step = test::stride(20);
  for (std::size_t seed = 0; seed < 500; seed += step) {
    test::Random random(seed);
    test::TimedCase made = makers[seed / step % makers.size()](random);
    test::use_default_interleave(made.machine);
    SCOPED_TRACE("seed " + std::to_string(seed));
    const std::vector<std::string> assignments = test::assignments_of(made.machine);
    const Case one(made.log, assignments);
    // The configuration describes the random machine.
    ASSERT_EQ(processors::replay::replay(made.log, made.machine).end, one.result.end);
    if (one.result.end > 0) {
      expect_followed(one);
      // As a run measures: with about as much work as the frame itself takes.
      constexpr Work some = 4;
      expect_advice_followed(
          one, what_helps(one.config, std::nullopt, one.machine, one.result, {made.log, nullptr, {}, {}},
                          some * replay_work(one.result, nullptr)));
    }
  }
}

// The noise is that of replays whose packets change places within 16 in a row.
TEST(Noise, IsTheSpreadOfOtherOrders) {
  for (std::size_t seed = 0; seed < makers.size() * 3; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    test::Random random(seed);
    test::TimedCase made = makers[seed % makers.size()](random);
    const MachineResult result = processors::replay::replay(made.log, made.machine);
    const SharedLog shared{made.log, nullptr, {}, {}};
    const Work one = std::max<Work>(1, replay_work(result, nullptr));
    const std::optional<OrderNoise> noise = measure_noise(shared, made.machine, result, unlimited_work);
    ASSERT_EQ(noise.has_value(), result.end > 0 && result.packets > 1);
    EXPECT_FALSE(measure_noise(shared, made.machine, result, 2 * one - 1));
    if (!noise) {
      continue;
    }
    sim::Ticks shortest = result.end;
    sim::Ticks longest = result.end;
    for (std::uint64_t order = 1; order <= noise_orders; ++order) {
      processors::replay::ReplayOptions options;
      options.packet_seed = order;
      const sim::Ticks end = processors::replay::replay(made.log, made.machine, options).end;
      shortest = std::min(shortest, end);
      longest = std::max(longest, end);
    }
    EXPECT_EQ(noise->replays, static_cast<std::int64_t>(noise_orders));
    EXPECT_EQ(noise->shortest, shortest);
    EXPECT_EQ(noise->longest, longest);
    EXPECT_EQ(measure_noise(shared, made.machine, result, 3 * one)->replays, 3);
  }
}

TEST(Noise, OrdersHandOutEachPacketOnceNearItsPlace) {
  processors::program::WorkLog log;
  log.width = 70;
  log.height = 9;
  MachineConfig machine;
  machine.packets = {2, 3, processors::machine::PacketOrder::hilbert};
  const auto usual = processors::replay::packets_of(log, machine, 0);
  std::set<std::vector<std::uint32_t>> orders;
  for (std::uint64_t seed = 1; seed <= noise_orders; ++seed) {
    const auto other = processors::replay::packets_of(log, machine, seed);
    ASSERT_EQ(other.size(), usual.size());
    std::vector<std::uint32_t> order;
    for (std::uint64_t first = 0; first < usual.size(); first += 16) {
      std::set<std::pair<std::uint32_t, std::uint32_t>> wanted;
      std::set<std::pair<std::uint32_t, std::uint32_t>> found;
      for (std::uint64_t i = first; i < std::min(usual.size(), first + 16); ++i) {
        wanted.emplace(usual[i].x0, usual[i].y0);
        found.emplace(other[i].x0, other[i].y0);
        order.push_back(other[i].x0 + other[i].y0 * log.width);
      }
      EXPECT_EQ(found, wanted);
    }
    orders.insert(order);
  }
  EXPECT_EQ(orders.size(), noise_orders);
}

TEST(Noise, MakesSavingsDoubtful) {
  WhatHelps what;
  what.end = 1000;
  MeasuredChange step;
  step.saved = 0.019;
  EXPECT_FALSE(within_noise(what, step));
  EXPECT_EQ(doubt_text(what, step), "");
  what.noise = {5, 990, 1010};
  EXPECT_TRUE(within_noise(what, step));
  EXPECT_EQ(doubt_text(what, step), " (no more than another order of packets, 2.00 %)");
  step.saved = 0.109;
  EXPECT_EQ(doubt_text(what, step), "");
  step.in_proportion = 1.0 - 1.0 / 1.1;
  EXPECT_EQ(doubt_text(what, step), " (more than the clock's 9.1 %: the rest is the packets' order)");
}

TEST(WhatHelps, IsTheSameWithOneThread) {
  test::Random random(5);
  const test::TimedCase made = test::image_case(random);
  const std::vector<std::string> assignments = test::assignments_of(made.machine);
  const Case all(made.log, assignments);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const Case one(made.log, assignments);
  EXPECT_EQ(all.what.sentence, one.what.sentence);
  ASSERT_EQ(all.what.helps.size(), one.what.helps.size());
  for (std::size_t i = 0; i < all.what.helps.size(); ++i) {
    EXPECT_EQ(all.what.helps[i].name, one.what.helps[i].name);
    EXPECT_EQ(all.what.helps[i].step ? all.what.helps[i].step->end : std::nullopt,
              one.what.helps[i].step ? one.what.helps[i].step->end : std::nullopt);
  }
}

std::size_t count_of(const WhatHelps& what, Outcome outcome) {
  return static_cast<std::size_t>(std::count_if(what.helps.begin(), what.helps.end(), [&](const Help& help) {
    return help.step && help.step->outcome == outcome;
  }));
}

// A budget takes steps away from what is measured without one, and says how many; it changes no other.
TEST(WhatHelps, KeepsToItsBudget) {
  test::Random random(7);
  const test::TimedCase made = test::pipeline_case(random);
  const Case all(made.log, test::assignments_of(made.machine));
  ASSERT_EQ(count_of(all.what, Outcome::work), 0U);
  ASSERT_GT(count_of(all.what, Outcome::measured), 6U);
  const SharedLog shared{made.log, nullptr, {}, {}};
  const Work replay = replay_work(all.result, nullptr);
  for (const Work budget : {replay - 1, 2 * replay, 4 * replay, 8 * replay}) {
    const WhatHelps some = what_helps(all.config, std::nullopt, all.machine, all.result, shared, budget);
    EXPECT_EQ(some.measured, budget >= replay);
    EXPECT_GT(unreplayed(some).work, 0U);
    EXPECT_LE(count_of(some, Outcome::measured), 8U + count_of(all.what, Outcome::needless));
    EXPECT_EQ(count_of(some, Outcome::measured) > 0, some.measured);
    for (const Help& help : some.helps) {
      if (help.step && help.step->end) {
        EXPECT_EQ(help.step->end, all.end_with(help.step->keys)) << help.name;
      }
    }
  }
}

// Settings of a machine that an architect of today may ask of: memories from one bank to DRAM, ways to memory
// of every kind, contexts, a second level, three schemes, all structures and both ways of shading.
std::vector<std::string> machine_of_today(std::uint64_t seed) {
  test::Random random(seed);
  std::vector<std::string> settings = {"image.width=64", "image.height=64", "image.max_depth=3"};
  const auto one_of = [&](std::initializer_list<const char*> texts) {
    return std::string(std::data(texts)[random() % texts.size()]);
  };
  const auto add = [&](const std::string& key, std::initializer_list<const char*> texts) {
    settings.push_back(key + "=" + one_of(texts));
  };
  add("scene.source", {"teapot:6", "teapot:10", "room:10", "spheres:3", "tetra:5"});
  add("structure.kind", {"octree", "grid", "bsp", "bvh"});
  if (random() % 3 == 0) {
    settings.insert(settings.end(),
                    {"image.integrator=path", "image.samples=2", "image.width=40", "image.height=40"});
  }
  add("costs.preset", {"unit", "arm1176-2003", "cortex-a510-2021"});
  add("node.clock", {"50 MHz", "500 MHz", "2 GHz"});
  add("machine.nodes", {"4", "16", "64", "256"});
  add("cache.size", {"2 KiB", "16 KiB", "64 KiB"});
  add("cache.line", {"32 B", "64 B"});
  add("packets.width", {"2", "4", "8", "16"});
  add("packets.height", {"2", "8"});
  const std::uint64_t scheme = random() % 8;
  if (scheme < 6) {
    add("node.contexts", {"1", "1", "2", "4"});
    if (scheme == 5) {
      settings.insert(settings.end(),
                      {std::string("l2.sharing=shared"), "l2.size=" + one_of({"64 KiB", "1 MiB"})});
    }
  } else if (scheme == 6) {
    settings.push_back("machine.scheme=space");
  } else {
    settings.push_back("machine.scheme=pipeline");
  }
  if (scheme == 6) {
    return settings;
  }
  add("interconnect.kind", {"bus", "bus", "crossbar", "crossbar", "ideal"});
  add("interconnect.width", {"4 B", "16 B", "64 B"});
  add("interconnect.clock", {"33 MHz", "400 MHz", "1500 MHz"});
  if (random() % 3 == 0) {
    settings.insert(settings.end(), {std::string("memory.model=dram"),
                                     "dram.preset=" + one_of({"ddr4-2400", "ddr5-4800", "hbm2-2000"})});
  } else {
    add("memory.banks", {"1", "4", "16"});
    add("memory.clock", {"33 MHz", "800 MHz"});
  }
  return settings;
}

// The step that is named within the work of a run is nearly the best of all, which --what-helps finds.
TEST(WhatHelps, NamesNearlyTheBestStepWithinTheWorkOfARun) {
  std::size_t tried = 0;
  std::size_t near = 0;
  double worst = 0.0;
  std::string missed;
  const std::size_t step = test::stride(8);
  for (std::uint64_t seed = 0; tried < 60 / step; ++seed) {
    const std::vector<std::string> settings = machine_of_today(seed);
    std::optional<sim::Config> config;
    std::optional<RunResult> run;
    try {
      config = sim::Config::from_text(run_schema(), "", "test", settings);
      RunOptions options;
      options.what_helps = Measuring::all;
      run.emplace(run::run(*config, std::move(options)));
    } catch (const sim::UserError&) {
      continue;  // settings that exclude each other
    }
    ++tried;
    const processors::program::WorkLog& log = *run->functional.frame.log;
    SharedLog shared{log, nullptr, {}, {}};
    if (processors::walk::StrippedLog::ways_of(run->machine) != 0) {
      shared.stripped = processors::walk::StrippedLog::make(log, run->machine, std::uint64_t{1} << 30U);
    }
    const WhatHelps some = what_helps(
        *config, std::nullopt, run->machine, run->timed, shared,
        100'000'000 + run_work(run->functional.totals, run->timed, run->one_node, shared.stripped.get()));
    const auto first = [](const WhatHelps& what) {
      const std::vector<const Help*> named = best_helps(what);
      return named.empty() ? 0.0 : *named[0]->step->saved;
    };
    const double lost = first(*run->helps) - first(some);
    EXPECT_GE(lost, -1e-12);
    near += lost <= 0.02 ? 1 : 0;
    worst = std::max(worst, lost);
    if (lost > 0.02) {
      missed += fmt::format("\nseed {}: {:.3f}; of all: {}; named: {}", seed, lost, run->helps->sentence,
                            some.sentence);
    }
  }
  EXPECT_GE(20 * near, 19 * tried) << missed;
  EXPECT_LT(worst, 0.2) << missed;
}

// A budget for a single replay is mostly enough to name something that helps.
TEST(WhatHelps, NamesSomethingWhereItCanReplayOneStep) {
  std::size_t advised = 0;
  for (std::size_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(seed);
    test::Random random(seed);
    test::TimedCase made = makers[seed % makers.size()](random);
    test::use_default_interleave(made.machine);
    sim::Config config = test::configuration_of(test::assignments_of(made.machine));
    const MachineConfig machine = read_machine(config);
    const MachineResult result = processors::replay::replay(made.log, machine);
    const SharedLog shared{made.log, nullptr, {}, {}};
    const Work replay = replay_work(result, nullptr);
    const WhatHelps some = what_helps(config, std::nullopt, machine, result, shared, replay);
    ASSERT_TRUE(some.measured || result.end == 0);
    std::size_t replayed = 0;
    for (const Help& help : some.helps) {
      const MeasuredChange& change = help.step ? *help.step : *help.best;
      // Of others it is known without a replay that they save nothing.
      replayed += change.end && change.most_saved >= worth_naming ? 1 : 0;
    }
    EXPECT_EQ(replayed, result.end > 0 ? 1U : 0U);
    advised += best_helps(some).size();
  }
  EXPECT_GT(advised, 20U);
}

// Numbers go to the next power of two, up to the least one that is of use; where rays move, packets are no
// limit.
TEST(WhatHelps, StepsToTheNextPowerOfTwo) {
  const auto nodes_step = [](const std::vector<std::string>& settings, std::uint64_t packets) -> std::string {
    const sim::Config config = test::configuration_of(settings);
    FrameFacts facts;
    facts.packets = packets;
    const Changer changer(config);
    for (const Resource& resource : resources_of(changer, machine_of(settings), facts)) {
      if (resource.name == "machine.nodes") {
        return resource.step ? resource.step->keys.front().to : "none";
      }
    }
    return "none";
  };
  EXPECT_EQ(nodes_step({"machine.nodes=16"}, 4096), "32");
  EXPECT_EQ(nodes_step({"machine.nodes=17"}, 31), "32");
  EXPECT_EQ(nodes_step({"machine.nodes=32"}, 31), "none") << "more than there are packets";
  EXPECT_EQ(nodes_step({"machine.nodes=24", "machine.scheme=space"}, 16), "32");
  EXPECT_EQ(next_power(0), 1);
  EXPECT_EQ(next_power(1), 2);
  EXPECT_EQ(next_power(31), 32);
  EXPECT_EQ(next_power(32), 64);
}

TEST(WhatHelps, SaysThatMachinesTakeTooMuchMemory) {
  test::Random random(5);
  const test::TimedCase made = test::image_case(random);
  const Case one(made.log, test::assignments_of(made.machine));
  const WhatHelps none = what_helps(one.config, std::nullopt, one.machine, one.result,
                                    {made.log, nullptr, {}, sim::MemoryBudget(0)});
  EXPECT_GT(unreplayed(none).memory, 0U);
  EXPECT_TRUE(best_helps(none).empty());
  EXPECT_TRUE(none.sentence.starts_with("no step alone of those that were tried makes the frame "))
      << none.sentence;
}

// One node that computes and waits for nothing: memory and host take no time.
TEST(WhatHelps, AFasterNodeShortensAFrameOfComputingByItsClock) {
  test::Random random(1);
  const processors::program::WorkLog log = test::random_log(random, 12, 12);
  const Case one(log, {"machine.nodes=1", "node.clock=100 MHz", "interconnect.kind=ideal",
                       "interconnect.latency_cycles=0", "host.assignment=blocks"});
  const Help* const clock = one.find("node.clock");
  ASSERT_NE(clock, nullptr);
  const std::int64_t cycles = one.result.end / 10'000;
  EXPECT_EQ(one.result.end, cycles * 10'000);
  EXPECT_EQ(clock->step->end, cycles * 9'091) << "110 MHz";
  EXPECT_FALSE(clock->best) << "a clock has no useful end";
  EXPECT_EQ(best_helps(one.what)[0]->name, "machine.nodes") << "two nodes halve it, nearly";
}

// Nodes that compute in no time ask for lines all the time: the bus, which moves only whole lines, is full.
const std::vector<std::string> full_bus = {"machine.nodes=4",
                                           "node.clock=1 THz",
                                           "costs.preset=unit",
                                           "costs.add=0",
                                           "costs.multiply=0",
                                           "costs.divide=0",
                                           "costs.square_root=0",
                                           "costs.compare=0",
                                           "costs.integer=0",
                                           "costs.load=0",
                                           "costs.store=0",
                                           "cache.organisation=none",
                                           "layout.node=32",
                                           "layout.entry=32",
                                           "layout.primitive=32",
                                           "layout.quadric=32",
                                           "layout.material=32",
                                           "layout.texel=32",
                                           "layout.pixel=32",
                                           "layout.record_alignment=32",
                                           "host.assignment=blocks",
                                           "interconnect.width=4 B",
                                           "interconnect.address_cycles=0",
                                           "interconnect.clock=50 MHz",
                                           "memory.clock=50 MHz",
                                           "memory.access_cycles=0",
                                           "memory.busy_cycles=0"};

TEST(WhatHelps, TwiceTheWidthOfAFullBusHalvesTheFrame) {
  test::Random random(2);
  const processors::program::WorkLog log = test::random_log(random, 12, 12);
  const Case one(log, full_bus);
  const Help* const width = one.find("interconnect.width");
  ASSERT_NE(width, nullptr);
  EXPECT_EQ(2 * *width->step->end, one.result.end);
  EXPECT_EQ(8 * *width->best->end, one.result.end) << "a line of 32 bytes in one beat";
  EXPECT_EQ(
      one.what.sentence,
      "interconnect.width 4 B -> 8 B: frame 50.0 % shorter (at its best, interconnect.width 4 B -> 32 B: "
      "87.5 %); the bus is 100.0 % busy");
}

// Bus and bank each take eight cycles for a line: whichever is made faster, the other is full.
TEST(WhatHelps, TriesTwoStepsWhereNoneHelpsAlone) {
  test::Random random(3);
  const processors::program::WorkLog log = test::random_log(random, 40, 40);
  std::vector<std::string> assignments = full_bus;
  assignments.insert(assignments.end(), {"machine.nodes=32", "memory.banks=1", "memory.busy_cycles=8"});
  const Case one(log, assignments);
  ASSERT_TRUE(one.what.pair.has_value()) << one.what.sentence;
  EXPECT_NE(one.what.sentence.find(" each alone saves less than "), std::string::npos) << one.what.sentence;
  EXPECT_TRUE(one.what.pair->first.starts_with("interconnect.") !=
              one.what.pair->second.starts_with("interconnect."))
      << one.what.sentence;
  expect_followed(one);
}

// What is no part of the machine costs nothing; parts of the machine may only lack a price.
TEST(WhatHelps, SaysWhatCostsNothing) {
  std::set<std::string> free;
  for (const auto& [file, assignment] :
       {std::pair("marti.toml", "build.sharing=none"), std::pair("dynamic.toml", "build.initial_level=2"),
        std::pair("space.toml", "space.level=3")}) {
    const std::vector<std::string> assignments = {"image.width=16", "image.height=12",
                                                  "scene.source=teapot:2", assignment};
    sim::Config config = sim::Config::from_file(
        run_schema(), std::filesystem::path(MARTI_SOURCE) / "configs" / file, assignments);
    const RunResult result = run::run(config, {.what_helps = Measuring::all, .prices = Prices()});
    for (const Help& help : result.helps->helps) {
      if (!help.step) {
        continue;
      }
      const std::string text = gain_text(help);
      const bool of_program =
          help.name.starts_with("packets.") || help.name.starts_with("build.") || help.name == "space.level";
      EXPECT_EQ(text.ends_with(", costs nothing"), of_program) << text;
      EXPECT_EQ(text.ends_with(", without a price"), !of_program && *help.step->price == 0.0) << text;
      if (of_program) {
        EXPECT_EQ(*help.step->price, 0.0) << text;
        free.insert(help.name);
      }
      Help unpriced = help;
      unpriced.step->price.reset();
      EXPECT_TRUE(text.starts_with(gain_text(unpriced))) << text;
      EXPECT_EQ(gain_text(unpriced).find("cost"), std::string::npos) << gain_text(unpriced);
    }
  }
  for (const char* name :
       {"packets.width", "packets.height", "build.sharing", "build.initial_level", "space.level"}) {
    EXPECT_TRUE(free.contains(name)) << name;
  }
}

TEST(WhatHelps, ChoosesByPriceWherePricesAreGiven) {
  test::Random random(2);
  const processors::program::WorkLog log = test::random_log(random, 12, 12);
  Prices prices;
  const Case free(log, full_bus);
  ASSERT_EQ(free.what.helps[0].name, "interconnect.width");
  prices.interconnect_byte = 0.0;
  const Case unpriced(log, full_bus, prices);
  ASSERT_FALSE(best_helps(unpriced.what).empty());
  for (const Help* help : best_helps(unpriced.what)) {
    EXPECT_EQ(help->step->price, 0.0) << help->name;
  }
  // The wider bus saves most, but the faster one is free. Of steps with a price that comes first which saves
  // most for each unit of it.
  prices.interconnect_byte = 2.0;
  const Case priced(log, full_bus, prices);
  EXPECT_EQ(priced.what.helps[0].name, "interconnect.clock");
  const Help* const width = priced.find("interconnect.width");
  ASSERT_NE(width, nullptr);
  EXPECT_EQ(width->step->price, 8.0);
  EXPECT_NE(gain_text(*width).find(", price +8"), std::string::npos) << gain_text(*width);
  for (std::size_t i = 1; i < best_helps(priced.what).size(); ++i) {
    const MeasuredChange& first = *best_helps(priced.what)[i - 1]->step;
    const MeasuredChange& next = *best_helps(priced.what)[i]->step;
    if (*next.price <= 0.0) {
      EXPECT_LE(*first.price, 0.0);
      EXPECT_GE(*first.saved, *next.saved);
    } else if (*first.price > 0.0) {
      EXPECT_GE(*first.saved / *first.price, *next.saved / *next.price);
    }
  }
}

TEST(WhatHelps, ANearlyFullBusIsNotRelievedByMoreNodes) {
  namespace fs = std::filesystem;
  const std::vector<std::string> assignments = {"image.width=128", "image.height=128", "machine.nodes=64",
                                                "interconnect.width=4 B"};
  for (const Measuring measuring : {Measuring::within_budget, Measuring::all}) {
    sim::Config config =
        sim::Config::from_file(run_schema(), fs::path(MARTI_SOURCE) / "configs" / "marti.toml", assignments);
    const RunResult result = run::run(config, {.what_helps = measuring});
    ASSERT_GT(result.figure("interconnect_utilisation").value_or(0.0), 0.9);
    ASSERT_TRUE(result.helps.has_value());
    EXPECT_TRUE(result.helps->sentence.starts_with("interconnect.width 4 B -> 8 B: frame "))
        << result.helps->sentence;
    EXPECT_NE(best_helps(*result.helps)[1]->part, Part::nodes);
  }
}

TEST(WhatHelps, ATreeThatIsBuiltBeforeTheFrameIsBetterBuiltOnDemand) {
  namespace fs = std::filesystem;
  const std::vector<std::string> assignments = {"image.width=64", "image.height=64",
                                                "build.initial_level=full"};
  sim::Config config =
      sim::Config::from_file(run_schema(), fs::path(MARTI_SOURCE) / "configs" / "dynamic.toml", assignments);
  const RunResult result = run::run(config, {.what_helps = Measuring::all});
  ASSERT_TRUE(result.helps.has_value());
  EXPECT_TRUE(result.helps->sentence.starts_with("build.initial_level full -> 1: frame "))
      << result.helps->sentence;
}

TEST(WhatHelps, AFrameWithoutTimeNeedsNothing) {
  const WhatHelps what = what_helps(test::configuration_of({}), std::nullopt, {}, {}, {{}, nullptr, {}, {}});
  EXPECT_EQ(what.sentence, "nothing: the frame takes no time on this machine");
  EXPECT_TRUE(what.helps.empty());
}

}  // namespace
}  // namespace marti::studies
