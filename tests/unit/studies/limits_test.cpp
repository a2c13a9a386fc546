// Predictions of what limits a point: oracles for their parts, closed forms, and a small sweep against
// replays.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "processors/theory/closed_network.h"
#include "studies/helps/verdict.h"
#include "studies/limits/frame_model.h"
#include "studies/limits/reuse_distances.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_row.h"
#include "tests/contract/random_cases.h"
#include "tests/support/configuration_of.h"
#include "tests/support/timed_sweep.h"

namespace marti::studies {

using namespace figures;
using namespace helps;
using namespace keys;
using namespace limits;
using namespace sweep;

namespace {

using processors::replay::MachineResult;

// With exponential service, whose half mean square is the square of the mean, it is mean value analysis.
TEST(QueueModel, IsMeanValueAnalysisForExponentialService) {
  test::Random random(3);
  for (int i = 0; i < 50; ++i) {
    processors::theory::ClosedNetwork network;
    network.customers = static_cast<std::uint64_t>(test::pick(random, 1, 60));
    network.think = static_cast<double>(test::pick(random, 1, 200));
    QueueModel model{network.think, {}};
    for (std::int64_t left = test::pick(random, 0, 4); left > 0; --left) {
      const auto demand = static_cast<double>(test::pick(random, 1, 40));
      network.demands.push_back(demand);
      model.stations.push_back({1.0, 1.0, demand, demand * demand});
      model.think += demand;
    }
    const double exact = processors::theory::mean_values(network).throughput;
    EXPECT_NEAR(throughputs(model, network.customers).back() / exact, 1.0, 1e-9);
  }
}

TEST(QueueModel, ServesNoMoreThanItsBusiestStation) {
  const QueueModel model{10.0, {{2.0, 1.0, 3.0, 4.5}, {1.0, 1.0, 1.0, 0.5}}};
  const std::vector<double> rates = throughputs(model, 500);
  EXPECT_TRUE(std::is_sorted(rates.begin(), rates.end()));
  EXPECT_LE(rates.back(), 1.0 / 6.0);
  EXPECT_NEAR(rates.back(), 1.0 / 6.0, 1e-3);
  EXPECT_DOUBLE_EQ(rates[1], 0.1);
  EXPECT_DOUBLE_EQ(throughput_at(rates, 0.5), 0.05);
  EXPECT_DOUBLE_EQ(throughput_at(rates, 1e6), rates.back());
}

// The oracle is the law itself, for distances of a power law and some first uses.
TEST(ReuseDistances, FindMissesOfOtherCaches) {
  const auto misses = [](double sets, double ways) {
    double sum = 100.0;  // first uses
    for (double distance = 1.0; distance <= 1024.0; distance += 1.0) {
      double fewer = 0.0;
      double term = std::exp(-distance / sets);
      for (double k = 0.0; k < ways; k += 1.0) {
        fewer += term;
        term *= distance / sets / (k + 1.0);
      }
      sum += 1e5 * std::pow(distance, -1.5) * (1.0 - fewer);
    }
    return sum;
  };
  std::vector<CacheMisses> known;
  for (const double lines : {32.0, 64.0, 128.0, 256.0, 512.0}) {
    for (const double ways : {1.0, 4.0}) {
      known.push_back({lines / ways, ways, misses(lines / ways, ways)});
    }
  }
  const ReuseDistances reuse(known);
  const auto ratio = [&](double lines, double ways) {
    return reuse.misses(lines / ways, ways) / misses(lines / ways, ways);
  };
  for (const double lines : {32.0, 64.0, 128.0, 256.0, 512.0}) {
    for (const double ways : {1.0, 2.0, 4.0}) {
      EXPECT_NEAR(ratio(lines, ways), 1.0, 0.1) << lines << " lines, " << ways << " ways";
    }
    EXPECT_NEAR(ratio(lines, 8.0) / ratio(lines, 4.0), 1.0, 0.1) << lines;
    // The error between two known caches lies between theirs.
    EXPECT_NEAR(ratio(lines, 2.0) / std::sqrt(ratio(lines, 1.0) * ratio(lines, 4.0)), 1.0, 0.03) << lines;
  }
  for (const double sets : {1.0, 8.0, 60.0}) {
    for (double ways = 1.0; ways < 600.0; ways *= 2.0) {
      EXPECT_GE(reuse.misses(sets, ways), reuse.misses(sets, 2.0 * ways) - 1e-9);
      EXPECT_GE(reuse.misses(sets, ways), reuse.misses(1.5 * sets, ways) - 1e-9);
    }
  }
}

TEST(FrameModel, GivesTheFrameThatItWasFittedTo) {
  int described = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    test::Random random(seed);
    const test::TimedCase made = test::image_case(random);
    const MachineResult result = processors::replay::replay(made.log, made.machine);
    const std::optional<FrameModel> model =
        FrameModel::of(made.machine, point_figures(counts_of(made.machine, result)));
    EXPECT_TRUE(!model || made.machine.placement == processors::machine::Placement::shared);
    if (model) {
      ++described;
      const double end = model->end_of(made.machine, model->work_on(made.machine));
      EXPECT_NEAR(end / static_cast<double>(result.end), 1.0, 1e-9) << "seed " << seed;
    }
  }
  EXPECT_GT(described, 50);
}

constexpr std::string_view small_frame =
    "[scene]\nsource = \"teapot:4\"\n[image]\nwidth = 24\nheight = 24\nmax_depth = 2\n"
    "[node]\nclock = \"100 MHz\"\n[packets]\nwidth = 2\nheight = 2\n";

test::TimedSweep sweep_of(const std::string& rest) {
  return test::TimedSweep(sim::Config::from_text(sweep_schema(), std::string(small_frame) + rest, "test"));
}

const PredictedStep* find(const PointLimit& limit, std::string_view name) {
  const auto found = std::find_if(limit.steps.begin(), limit.steps.end(),
                                  [&](const PredictedStep& step) { return step.name == name; });
  return found == limit.steps.end() ? nullptr : &*found;
}

// One packet on one node that waits for nothing: only its clock, and the hits of its cache, take time.
TEST(SweepLimits, OneNodeOnAnIdealInterconnectIsLimitedByItsClock) {
  const test::TimedSweep sweep = sweep_of(
      "[interconnect]\nkind = \"ideal\"\nlatency_cycles = 0\n[host]\nassignment = \"blocks\"\n"
      "[machine]\nnodes = 1\n[sweep.axes]\npackets.width = [24, 30]\npackets.height = [24]\n");
  const PointLimit limit = sweep.limits().at(0);
  ASSERT_NE(limit.best(), nullptr);
  EXPECT_EQ(limit.best()->name, "node.clock");
  EXPECT_EQ(limit.best()->basis, LimitBasis::model);
  EXPECT_NEAR(limit.best()->saved, 1.0 - 1.0 / 1.1, 1e-4);
  EXPECT_TRUE(limit.open().empty()) << limit.sentence();
}

// A packet larger than the image is the whole frame, however large it is: even where its pixels do not fit 32
// bits.
TEST(SweepLimits, LargePacketsAreCutAlike) {
  const auto packets_step = [](const std::string& side) {
    const test::TimedSweep sweep = sweep_of(
        "[sweep.axes]\nmachine.nodes = [1, 4]\n"
        "packets.width = [" +
        side + "]\npackets.height = [" + side + "]\n");
    const PointLimit limit = sweep.limits().at(1);
    const PredictedStep* const step = find(limit, "packets.width");
    EXPECT_NE(step, nullptr) << limit.sentence();
    return step != nullptr ? step->saved : -1.0;
  };
  const double saved = packets_step("32768");
  EXPECT_GT(saved, 0.0);
  EXPECT_DOUBLE_EQ(packets_step("65536"), saved);
}

// Without caches 64 nodes keep a slow bus busy all the time: its clock shortens the frame by as much.
TEST(SweepLimits, AFullBusIsTheLimit) {
  const test::TimedSweep sweep = sweep_of(
      "[cache]\norganisation = \"none\"\n[interconnect]\nkind = \"bus\"\nclock = \"5 MHz\"\n"
      "[sweep.axes]\nmachine.nodes = [48, 64]\n");
  const PointLimit limit = sweep.limits().at(1);
  ASSERT_NE(limit.best(), nullptr);
  EXPECT_EQ(limit.best()->part, Part::interconnect) << limit.sentence();
  EXPECT_EQ(limit.best()->basis, LimitBasis::bound);
  EXPECT_NE(limit.sentence().find("the bus is 9"), std::string::npos) << limit.sentence();
  const PredictedStep* const clock = find(limit, "interconnect.clock");
  ASSERT_NE(clock, nullptr);
  EXPECT_NEAR(clock->saved, 1.0 - 1.0 / 1.1, 0.01);
  EXPECT_NEAR(find(limit, "node.clock")->saved, 0.0, 0.01);
}

// A direct-mapped cache that a neighbour with four ways shows to be too small in ways.
TEST(SweepLimits, ANeighbourShowsThatTheCacheIsTooSmall) {
  test::TimedSweep sweep = sweep_of(
      "[machine]\nnodes = 16\n[cache]\nline = \"32 B\"\nsize = \"8 KiB\"\n[interconnect]\n"
      "kind = \"bus\"\nclock = \"10 MHz\"\nwidth = \"32 B\"\n[sweep.axes]\ncache.ways = [1, 2, 4]\n");
  const PointLimit limit = sweep.limits().at(0);
  const PredictedStep* const ways = find(limit, "cache.ways");
  ASSERT_NE(ways, nullptr);
  EXPECT_EQ(ways->basis, LimitBasis::neighbour);
  EXPECT_DOUBLE_EQ(ways->saved,
                   1.0 - static_cast<double>(sweep.result(1).end) / static_cast<double>(sweep.result(0).end));
  // Without it, the step lies between two points.
  const test::TimedSweep coarse = sweep_of(
      "[machine]\nnodes = 16\n[cache]\nline = \"32 B\"\nsize = \"8 KiB\"\n[interconnect]\n"
      "kind = \"bus\"\nclock = \"10 MHz\"\nwidth = \"32 B\"\n[sweep.axes]\ncache.ways = [1, 4]\n");
  const PointLimit between = coarse.limits().at(0);
  const PredictedStep* const guessed = find(between, "cache.ways");
  ASSERT_NE(guessed, nullptr);
  EXPECT_EQ(guessed->basis, LimitBasis::interpolated);
  EXPECT_NEAR(guessed->saved, ways->saved, 0.1);
  EXPECT_TRUE(guessed->rests_on.starts_with("interpolated: cache.ways 1 -> 4 saves ")) << guessed->rests_on;
  // The size is on no axis.
  EXPECT_EQ(find(between, "cache.size")->basis, LimitBasis::unknown);
  EXPECT_EQ(find(between, "cache.size")->saved, 0.0);
}

// Of other schemes only what the sweep has timed is known.
TEST(SweepLimits, OfAPipelineOnlyNeighboursSpeak) {
  const test::TimedSweep sweep = sweep_of(
      "[machine]\nscheme = \"pipeline\"\nnodes = 8\n"
      "[sweep.axes]\nnetwork.width = [1, 2, 8]\nnode.clock = [\"50 MHz\", \"100 MHz\"]\n");
  const PointLimit limit = sweep.limits().at(0);
  for (const PredictedStep& step : limit.steps) {
    const bool neighbour = step.name == "network.width" || step.name == "node.clock";
    EXPECT_EQ(step.basis != LimitBasis::unknown, neighbour) << step.name;
  }
  EXPECT_EQ(find(limit, "network.width")->basis, LimitBasis::neighbour);
  EXPECT_EQ(find(limit, "node.clock")->basis, LimitBasis::interpolated);
  EXPECT_FALSE(limit.open().empty());
  EXPECT_NE(limit.sentence().find("; not known: "), std::string::npos);
  EXPECT_NE(limit.sentence().find(" and " + std::to_string(limit.open().size() - 4) + " more"),
            std::string::npos);
}

// Whatever the machine, alone or beside another: no gain is invented, and all are possible.
TEST(SweepLimits, SayNothingImpossibleOfMachinesOfEveryKind) {
  using Maker = test::TimedCase (*)(test::Random&);
  constexpr std::array<Maker, 5> makers = {test::image_case, test::contexts_case, test::building_case,
                                           test::pipeline_case, test::space_case};
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    test::Random random(seed);
    test::TimedCase made = makers[seed % makers.size()](random);
    test::use_default_interleave(made.machine);
    const sim::Config config = test::configuration_of(test::assignments_of(made.machine));
    const PointFigures figures =
        point_figures(counts_of(made.machine, processors::replay::replay(made.log, made.machine)));
    if (figures.end == 0.0) {
      continue;
    }
    const SweepLimits limits({"machine.nodes", "cache.size"}, {{config, figures, figures}});
    const PointLimit limit = limits.at(0);
    EXPECT_FALSE(limit.sentence().empty());
    const bool modelled = FrameModel::of(made.machine, figures).has_value();
    for (const PredictedStep& step : limit.steps) {
      EXPECT_TRUE(std::isfinite(step.saved)) << seed << " " << step.name;
      EXPECT_LT(step.saved, 1.0) << seed << " " << step.name;
      const bool unknown = step.basis == LimitBasis::unknown;
      EXPECT_TRUE(unknown ? step.saved == 0.0 : !step.rests_on.empty()) << seed << " " << step.name;
      EXPECT_TRUE(unknown || modelled || step.saved == 0.0) << seed << " " << step.name;
    }
  }
}

TEST(SweepLimits, AgreeWithReplays) {
  test::TimedSweep sweep = sweep_of(
      "[cache]\nline = \"32 B\"\n[interconnect]\nkind = \"bus\"\n[sweep.axes]\n"
      "machine.nodes = [1, 4, 16]\ncache.size = [\"1 KiB\", \"2 KiB\", \"4 KiB\"]\n"
      "cache.ways = [1, 4]\ninterconnect.width = [\"4 B\", \"16 B\"]\n");
  const SweepLimits limits = sweep.limits();
  std::size_t right = 0;
  for (std::size_t i = 0; i < sweep.points(); ++i) {
    const WhatHelps what = sweep.measure(i, std::nullopt);
    const PointLimit limit = limits.at(i);
    double best = 0.0;
    double named = 0.0;
    for (const Help& help : what.helps) {
      const PredictedStep* const step = find(limit, help.name);
      ASSERT_EQ(step != nullptr, help.step.has_value()) << help.name;
      if (step == nullptr || !help.step->saved) {
        continue;
      }
      best = std::max(best, *help.step->saved);
      named = limit.best() == step ? *help.step->saved : named;
      EXPECT_EQ(describe(step->keys), describe(help.step->keys));
      if (step->basis == LimitBasis::neighbour) {
        EXPECT_DOUBLE_EQ(step->saved, *help.step->saved);
      }
    }
    ASSERT_NE(limit.best(), nullptr);
    EXPECT_NE(limit.best()->basis, LimitBasis::unknown);
    right += best - named <= tie ? 1 : 0;
  }
  EXPECT_GE(right * 10, sweep.points() * 9) << right << " of " << sweep.points();
}

// What a store keeps of a point is enough.
TEST(SweepLimits, AreTheSameFromTheSettingsOfAStore) {
  const test::TimedSweep sweep =
      sweep_of("[sweep.axes]\nmachine.nodes = [2, 8]\ncache.size = [\"1 KiB\", \"4 KiB\"]\n");
  std::vector<LimitPoint> points;
  for (std::size_t i = 0; i < sweep.points(); ++i) {
    points.push_back({sweep.stored_config(i), point_figures(counts_of(sweep.machine(i), sweep.result(i)))});
  }
  const SweepLimits stored({"machine.nodes", "cache.size"}, points);
  for (LimitPoint& point : points) {
    point.config = sweep.config(static_cast<std::size_t>(&point - points.data()));
  }
  const SweepLimits given({"machine.nodes", "cache.size"}, points);
  for (std::size_t i = 0; i < sweep.points(); ++i) {
    EXPECT_EQ(stored.at(i).sentence(), given.at(i).sentence());
    ASSERT_NE(stored.at(i).best(), nullptr);
    EXPECT_EQ(stored.at(i).best()->saved, given.at(i).best()->saved);
  }
}

// With prices a step that costs nothing comes before one that does.
TEST(SweepLimits, RankByPriceWherePricesAreGiven) {
  const test::TimedSweep sweep =
      sweep_of("[machine]\nnodes = 4\n[cache]\nsize = \"16 KiB\"\n[sweep.axes]\nmachine.nodes = [4, 8]\n");
  const PointLimit plain = sweep.limits().at(0);
  EXPECT_EQ(plain.best()->name, "machine.nodes");
  EXPECT_EQ(plain.best()->price, 0.0);
  const PointLimit priced = sweep.limits(Prices{}).at(0);
  EXPECT_EQ(priced.best()->name, "node.clock");
  EXPECT_GT(find(priced, "machine.nodes")->price, 0.0);
}

}  // namespace
}  // namespace marti::studies
