// The cheaper methods at their exact limits, and whether their intervals hold.
#include "studies/estimate/simulator_methods.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "processors/passes/one_pass.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/estimate/error_metrics.h"
#include "studies/estimate/packet_schedule.h"
#include "studies/estimate/simulator_analytic.h"
#include "studies/estimate/simulator_sample.h"
#include "tests/support/random_machine.h"

namespace marti::studies {
namespace {

using processors::MachineConfig;

// A machine that every method can estimate.
MachineConfig plain_machine(test::Random& random) {
  MachineConfig machine;
  machine.nodes = static_cast<std::uint32_t>(test::pick(random, 1, 9));
  machine.packets = {static_cast<std::uint32_t>(test::pick(random, 1, 4)),
                     static_cast<std::uint32_t>(test::pick(random, 1, 4)),
                     static_cast<processors::PacketOrder>(test::pick(random, 0, 2))};
  machine.cache.cache = {.size = 32ULL << test::pick(random, 0, 8), .line = 32, .ways = 1};
  return machine;
}

RC_GTEST_PROP(Strata, EachPacketIsDrawnOnceAndEachStratumSays, (std::uint64_t seed)) {
  test::Random random(seed);
  const auto packets = static_cast<std::uint64_t>(test::pick(random, 1, 200));
  const auto wanted = static_cast<std::uint64_t>(test::pick(random, 1, 220));
  const std::vector<Stratum> strata = draw_strata(packets, wanted, seed);
  std::uint64_t next = 0;
  std::uint64_t drawn = 0;
  for (const Stratum& stratum : strata) {
    RC_ASSERT(stratum.first == next);
    next = stratum.end;
    drawn += stratum.chosen.size();
    RC_ASSERT(stratum.chosen.size() <= stratum.size());
    RC_ASSERT((stratum.chosen.size() >= 2 || wanted < 2 || packets < 2));
    for (std::size_t i = 0; i < stratum.chosen.size(); ++i) {
      RC_ASSERT(stratum.chosen[i] >= stratum.first && stratum.chosen[i] < stratum.end);
      RC_ASSERT((i == 0 || stratum.chosen[i - 1] < stratum.chosen[i]));  // RapidCheck's || asks for both
    }
  }
  RC_ASSERT(next == packets);
  RC_ASSERT(drawn == std::min(packets, wanted));
  RC_ASSERT(drawn == [&] {
    std::uint64_t again = 0;
    for (const Stratum& stratum : draw_strata(packets, wanted, seed)) {
      again += stratum.chosen.size();
    }
    return again;
  }());
}

// The interval of the estimator itself, on packets whose times nearly follow their words.
TEST(RatioEstimate, ItsIntervalCoversTheTotal) {
  std::mt19937_64 random(11);
  constexpr std::uint64_t packets = 600;
  std::vector<std::uint64_t> words(packets);
  std::vector<double> times(packets);
  std::normal_distribution<double> noise(0.0, 0.2);
  for (std::uint64_t i = 0; i < packets; ++i) {
    words[i] = 50 + i + random() % 400;
    times[i] = 7.0 * static_cast<double>(words[i]) * std::exp(noise(random));
  }
  const double truth = std::accumulate(times.begin(), times.end(), 0.0);
  for (const std::uint64_t wanted : {20, 60, 200}) {
    int covered = 0;
    constexpr int trials = 400;
    for (int trial = 0; trial < trials; ++trial) {
      const std::vector<Stratum> strata = draw_strata(packets, wanted, static_cast<std::uint64_t>(trial));
      std::vector<double> measured;
      for (const Stratum& stratum : strata) {
        for (const std::uint64_t packet : stratum.chosen) {
          measured.push_back(times[packet]);
        }
      }
      const RatioEstimate estimate = ratio_estimate(strata, words, measured);
      covered += std::abs(truth / estimate.total - 1.0) <= estimate.half_width ? 1 : 0;
    }
    EXPECT_GE(covered, trials * 9 / 10) << wanted;
  }
}

TEST(RatioEstimate, AllPacketsAreTheTotal) {
  const std::vector<std::uint64_t> words = {1, 2, 3, 4, 5};
  const std::vector<double> times = {9.0, 7.0, 1.0, 2.0, 2.0};
  const RatioEstimate estimate = ratio_estimate(draw_strata(5, 5, 1), words, times);
  EXPECT_EQ(estimate.total, 21.0);
  EXPECT_EQ(estimate.half_width, 0.0);
}

RC_GTEST_PROP(Sample, OfEverythingIsExact, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_log(random, 12, 10);
  const MachineConfig machine = plain_machine(random);
  const MachineFigures exact = figures_of(machine, processors::replay(log, machine));
  const Estimate sampled = estimate_by_sample(log, machine, {.one_in = 1, .seed = seed});
  RC_ASSERT(sampled.value == exact);
  RC_ASSERT(sampled.half_width == MachineFigures());
}

// Packets of one node, warmed by all before: only the error of sampling is left, which the interval covers.
TEST(Sample, IntervalsOfManySeedsCoverTheTruth) {
  test::Random random(5);
  const processors::WorkLog log = test::random_log(random, 48, 40, 20);
  MachineConfig machine = plain_machine(random);
  machine.packets = {2, 2, processors::PacketOrder::scanline};
  machine.nodes = 1;
  const MachineFigures exact = figures_of(machine, processors::replay(log, machine));
  for (const std::uint64_t one_in : {4, 16}) {
    int times = 0;
    int misses = 0;
    constexpr int trials = 100;
    for (int seed = 0; seed < trials; ++seed) {
      const Estimate estimate = estimate_by_sample(log, machine,
                                                   {.one_in = one_in,
                                                    .warm_up = processors::PacketSample::all_before,
                                                    .seed = static_cast<std::uint64_t>(seed)});
      const auto holds = [&](Figure figure) {
        return std::abs(exact[figure] / estimate.value[figure] - 1.0) <= estimate.half_width[figure];
      };
      times += holds(Figure::end) ? 1 : 0;
      misses += holds(Figure::misses) ? 1 : 0;
    }
    EXPECT_GE(times, 90) << one_in;
    EXPECT_GE(misses, 90) << one_in;
  }
}

RC_GTEST_PROP(Schedule, OfIndependentPacketsIsTheReplay, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = plain_machine(random);
  machine.host.occupancy_cycles = test::pick(random, 0, 50);
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  const std::uint64_t packets = processors::PacketList(12, 10, machine.packets).size();
  std::vector<std::uint64_t> all(packets);
  std::iota(all.begin(), all.end(), 0);
  const processors::PacketSample sample(all, packets, 0);
  const processors::MachineResult result = processors::replay(log, machine, {.sample = &sample});
  std::vector<sim::Ticks> times;
  for (const processors::PacketFigures& figures : result.packet_figures) {
    times.push_back(figures.time);
  }
  sim::Ticks finish = 0;
  for (const processors::NodeStatistics& node : result.nodes) {
    finish = std::max(finish, node.finish);
  }
  RC_ASSERT(schedule_packets(machine.host, machine.nodes, times) == finish);
}

RC_GTEST_PROP(OnePass, FindsTheStepsAndMissesOfTheReplay, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_log(random, 11, 9);
  MachineConfig machine = plain_machine(random);
  machine.host.assignment = processors::Assignment::interleaved;
  const std::uint64_t packets = processors::PacketList(11, 9, machine.packets).size();
  std::vector<std::vector<std::uint64_t>> of_node(machine.nodes);
  for (std::uint64_t packet = 0; packet < packets; ++packet) {
    of_node[packet % machine.nodes].push_back(packet);
  }
  std::vector<MachineConfig> machines;
  std::vector<memory::CacheShape> shapes;
  for (const memory::CacheConfig& cache : {memory::CacheConfig{.size = 32, .line = 32, .ways = 1},
                                           {.size = 1024, .line = 32, .ways = 2},
                                           {.size = 4096, .line = 32, .ways = memory::full_ways},
                                           {.size = 768, .line = 32, .ways = 4}}) {
    machines.push_back(machine);
    machines.back().cache.cache = cache;
    shapes.push_back(memory::shape_of(cache));
  }
  const processors::OnePass pass = processors::one_pass(log, machine, shapes, of_node);
  for (std::size_t i = 0; i < machines.size(); ++i) {
    const processors::MachineResult result = processors::replay(log, machines[i]);
    RC_ASSERT(pass.misses[i] == result.references().all_misses());
    RC_ASSERT(pass.references == result.references().references());
    RC_ASSERT(pass.steps.tests == result.steps().tests);
    RC_ASSERT(pass.steps.pixels == result.steps().pixels);
    RC_ASSERT(pass.steps.branches == result.steps().branches);
  }
  const std::vector<std::uint64_t> words = processors::words_of_packets(log, machine.packets);
  RC_ASSERT(std::accumulate(words.begin(), words.end(), std::uint64_t{0}) == pass.words);
}

// One node never waits, so the method has nothing to approximate.
RC_GTEST_PROP(Analytic, OneNodeWithAnIdealInterconnectIsExact, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = plain_machine(random);
  machine.nodes = 1;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.latency_cycles = test::pick(random, 0, 90);
  machine.write_buffer = 120;  // one for each pixel: it never fills
  const MachineFigures exact = figures_of(machine, processors::replay(log, machine));
  const memory::CacheShape shape = memory::shape_of(machine.cache.cache);
  const Estimate estimate = estimate_analytically(log, machine, {&shape, 1}, {.walked_nodes = 1})[0];
  RC_ASSERT(estimate.value[Figure::misses] == exact[Figure::misses]);
  RC_ASSERT(estimate.value[Figure::end] == exact[Figure::end]);
}

// With all nodes walked, the misses are those of interleaved assignment.
RC_GTEST_PROP(Analytic, AllNodesWalkedGiveTheMissesOfInterleavedAssignment, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = plain_machine(random);
  const memory::CacheShape shape = memory::shape_of(machine.cache.cache);
  const Estimate estimate = estimate_analytically(log, machine, {&shape, 1}, {.walked_nodes = 1000})[0];
  MachineConfig interleaved = machine;
  interleaved.host.assignment = processors::Assignment::interleaved;
  RC_ASSERT(estimate.value[Figure::misses] ==
            static_cast<double>(processors::replay(log, interleaved).references().all_misses()));
  RC_ASSERT(estimate.value[Figure::use] >= 0.0);
  RC_ASSERT(estimate.value[Figure::use] <= 1.0);
}

RC_GTEST_PROP(Methods, TheSameQuestionHasTheSameAnswer, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::WorkLog log = test::random_log(random, 7, 5, 20);
  const MachineConfig machine = plain_machine(random);
  for (const Method& method : simulator_methods()) {
    if (answers_alone(method)) {
      const Estimate first = estimate(method, log, machine, 3);
      const Estimate second = estimate(method, log, machine, 3);
      RC_ASSERT(first.value == second.value);
      RC_ASSERT(first.half_width == second.half_width);
      RC_ASSERT(first.events == second.events);
      RC_ASSERT(first.words == second.words);
    }
  }
}

TEST(Methods, AreNamedApartAndRefuseWhatTheyCannotDo) {
  std::vector<std::string> names;
  test::Random random(1);
  MachineConfig pipeline = plain_machine(random);
  pipeline.scheme = processors::Scheme::pipeline;
  for (const Method& method : simulator_methods()) {
    names.push_back(method.name() + ": " + method.knob());
    if (method.kind != MethodKind::exact && answers_alone(method)) {
      EXPECT_THROW(check_method(method, pipeline), sim::UserError) << names.back();
    }
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_EQ(simulator_methods()[0].kind, MethodKind::exact);
}

}  // namespace
}  // namespace marti::studies
