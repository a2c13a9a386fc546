// The cheaper methods at their exact limits.
#include "studies/estimate/simulator_methods.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>
#include <numeric>

#include "plain_machine.h"
#include "processors/passes/one_pass.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "studies/estimate/packet_schedule.h"
#include "studies/estimate/simulator_analytic.h"
#include "tests/support/random_machine.h"

namespace marti::studies {

using namespace estimate;

namespace {

using processors::machine::MachineConfig;

RC_GTEST_PROP(Schedule, OfIndependentPacketsIsTheReplay, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = test::plain_machine(random);
  machine.host.occupancy_cycles = test::pick(random, 0, 50);
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  const std::uint64_t packets = processors::machine::PacketList(12, 10, machine.packets).size();
  std::vector<std::uint64_t> all(packets);
  std::iota(all.begin(), all.end(), 0);
  const processors::walk::PacketSample sample(all, packets, 0);
  const processors::replay::MachineResult result =
      processors::replay::replay(log, machine, {.sample = &sample});
  std::vector<sim::Ticks> times;
  for (const processors::walk::PacketFigures& figures : result.packet_figures) {
    times.push_back(figures.time);
  }
  sim::Ticks finish = 0;
  for (const processors::cost::NodeStatistics& node : result.nodes) {
    finish = std::max(finish, node.finish);
  }
  RC_ASSERT(schedule_packets(machine.host, machine.nodes, times) == finish);
}

RC_GTEST_PROP(OnePass, FindsTheStepsAndMissesOfTheReplay, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_log(random, 11, 9);
  MachineConfig machine = test::plain_machine(random);
  machine.host.assignment = processors::machine::Assignment::interleaved;
  const std::uint64_t packets = processors::machine::PacketList(11, 9, machine.packets).size();
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
  const processors::passes::OnePass pass = processors::passes::one_pass(log, machine, shapes, of_node);
  for (std::size_t i = 0; i < machines.size(); ++i) {
    const processors::replay::MachineResult result = processors::replay::replay(log, machines[i]);
    RC_ASSERT(pass.misses[i] == result.references().all_misses());
    RC_ASSERT(pass.references == result.references().references());
    RC_ASSERT(pass.steps.tests == result.steps().tests);
    RC_ASSERT(pass.steps.pixels == result.steps().pixels);
    RC_ASSERT(pass.steps.branches == result.steps().branches);
  }
  const std::vector<std::uint64_t> words = processors::passes::words_of_packets(log, machine.packets);
  RC_ASSERT(std::accumulate(words.begin(), words.end(), std::uint64_t{0}) == pass.words);
}

// One node never waits, so the method has nothing to approximate.
RC_GTEST_PROP(Analytic, OneNodeWithAnIdealInterconnectIsExact, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = test::plain_machine(random);
  machine.nodes = 1;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  machine.interconnect.latency_cycles = test::pick(random, 0, 90);
  machine.write_buffer = 120;  // one for each pixel: it never fills
  const MachineFigures exact = figures_of(machine, processors::replay::replay(log, machine));
  const memory::CacheShape shape = memory::shape_of(machine.cache.cache);
  const Estimate estimate = estimate_analytically(log, machine, {&shape, 1}, {.walked_nodes = 1})[0];
  RC_ASSERT(estimate.value[Figure::misses] == exact[Figure::misses]);
  RC_ASSERT(estimate.value[Figure::end] == exact[Figure::end]);
}

// With all nodes walked, the misses are those of interleaved assignment.
RC_GTEST_PROP(Analytic, AllNodesWalkedGiveTheMissesOfInterleavedAssignment, (std::uint64_t seed)) {
  test::Random random(seed);
  const processors::program::WorkLog log = test::random_log(random, 12, 10);
  MachineConfig machine = test::plain_machine(random);
  const memory::CacheShape shape = memory::shape_of(machine.cache.cache);
  const Estimate estimate = estimate_analytically(log, machine, {&shape, 1}, {.walked_nodes = 1000})[0];
  MachineConfig interleaved = machine;
  interleaved.host.assignment = processors::machine::Assignment::interleaved;
  RC_ASSERT(estimate.value[Figure::misses] ==
            static_cast<double>(processors::replay::replay(log, interleaved).references().all_misses()));
  RC_ASSERT(estimate.value[Figure::use] >= 0.0);
  RC_ASSERT(estimate.value[Figure::use] <= 1.0);
}

TEST(Methods, AreNamedApartAndRefuseWhatTheyCannotDo) {
  std::vector<std::string> names;
  test::Random random(1);
  MachineConfig pipeline = test::plain_machine(random);
  pipeline.scheme = processors::machine::Scheme::pipeline;
  for (const Method& method : simulator_methods()) {
    names.push_back(method.name() + ": " + method.knob());
    if (method.kind == MethodKind::sampled || method.kind == MethodKind::analytic) {
      EXPECT_THROW(check_method(method, pipeline), sim::UserError) << names.back();
    }
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_EQ(simulator_methods()[0].kind, MethodKind::exact);
}

}  // namespace
}  // namespace marti::studies
