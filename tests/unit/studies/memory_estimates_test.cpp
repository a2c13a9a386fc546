// Estimates made before memory is taken, against what the operating system counts. A program of its own:
// each measurement forks, and a fork has no threads of oneTBB's.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "processors/machine/machine_config.h"
#include "processors/replay/host_bytes.h"
#include "processors/replay/replay.h"
#include "studies/run/run_result.h"
#include "studies/sweep/plan/sweep_keys.h"
#include "studies/sweep/plan/sweep_plan.h"
#include "tests/support/measured_memory.h"
#include "tests/support/random_machine.h"
#include "tests/support/user_error.h"

namespace marti::studies {

using namespace sweep;

namespace {

using processors::machine::CacheOrganisation;
using processors::machine::MachineConfig;

struct Case {
  const char* name;
  void (*change)(MachineConfig& machine);
};

TEST(MemoryEstimates, OfMachinesAreNotTooLow) {
  if (!test::memory_can_be_measured) {
    GTEST_SKIP() << "a sanitizer takes memory of its own";
  }
  const std::vector<Case> cases = {
      {"no cache", [](MachineConfig& m) { m.cache.organisation = CacheOrganisation::none; }},
      {"unified", [](MachineConfig& m) { m.cache.organisation = CacheOrganisation::unified; }},
      {"contexts",
       [](MachineConfig& m) {
         m.cache.organisation = CacheOrganisation::none;
         m.contexts = 4;
         m.nodes /= 4;
       }},
      {"contexts without a packet",
       [](MachineConfig& m) {
         m.cache.organisation = CacheOrganisation::none;
         m.contexts = 256;
       }},
      {"replicated",
       [](MachineConfig& m) {
         m.cache.organisation = CacheOrganisation::none;
         m.placement = processors::machine::Placement::replicated;
       }},
      {"random",
       [](MachineConfig& m) {
         m.cache.cache.size = 4096;
         m.cache.cache.ways = 1;
         m.cache.cache.replacement = memory::Replacement::random;
       }},
      {"sharing",
       [](MachineConfig& m) {
         m.cache.organisation = CacheOrganisation::none;
         std::swap(m.clusters, m.nodes);
         m.count.sharing = true;  // most bytes are for the clusters' numbers
       }},
      {"trees",
       [](MachineConfig& m) {
         m.cache.organisation = CacheOrganisation::none;
         m.build.sharing = processors::machine::Sharing::private_trees;
       }},
      {"order", [](MachineConfig& m) { m.packets.order = processors::machine::PacketOrder::hilbert; }},
  };
  test::Random random(3);
  // A packet for each node: the tags of a node without one take no memory.
  const processors::program::WorkLog plain = test::random_log(random, 192, 192, 4);
  const processors::program::WorkLog with_tree = test::random_tree_log(random, 192, 192);
  for (const Case& one : cases) {
    MachineConfig machine;
    machine.nodes = 192 * 192;
    machine.packets = {1, 1, processors::machine::PacketOrder::scanline};
    one.change(machine);
    const bool given = machine.build.sharing == processors::machine::Sharing::given;
    const processors::program::WorkLog& log = given ? plain : with_tree;
    const auto measured = [&] {
      return static_cast<double>(test::peak_bytes([&] { (void)processors::replay::replay(log, machine); }));
    };
    const auto estimate = static_cast<double>(processors::replay::host_bytes(log, machine));
    double peak = measured();
    // A system that has taken pages of the program away, which come back while it works, adds some megabytes.
    for (int again = 0; again < 3 && estimate <= 0.9 * peak; ++again) {
      peak = std::min(peak, measured());
    }
    EXPECT_GT(estimate, 0.9 * peak) << one.name << ": " << estimate / machine.nodes
                                    << " bytes a node, measured " << peak / machine.nodes;
    // Each node refers to few of the lines that sharing may be counted for.
    EXPECT_LT(estimate, (machine.count.sharing ? 8.0 : 2.0) * peak)
        << one.name << ": " << estimate / machine.nodes << " bytes a node, measured " << peak / machine.nodes;
  }
}

sim::Config sweep_of(const std::string& nodes, const std::string& latencies) {
  return sim::Config::from_text(sweep_schema(),
                                "scene.source = \"teapot:2\"\n[sweep.axes]\nmachine.nodes = \"1.." + nodes +
                                    "\"\nhost.latency_cycles = \"1.." + latencies + "\"\n",
                                "sweep.toml");
}

// Plans of 20,000 points with a machine each.
TEST(MemoryEstimates, OfPlansAreNotTooLow) {
  if (!test::memory_can_be_measured) {
    GTEST_SKIP() << "a sanitizer takes memory of its own";
  }
  constexpr std::uint64_t points = 20'000;
  const auto peak = static_cast<double>(test::peak_bytes([] {
    sim::Config config = sweep_of("100", "200");
    static const SweepPlan plan = plan_sweep(config);
  }));
  // Memory that does not grow with the points: the configuration, and the points that are read at a time.
  const auto fixed = static_cast<double>(test::peak_bytes([] {
    sim::Config config = sweep_of("10", "60");
    static const SweepPlan plan = plan_sweep(config);
  }));
  const auto estimate = static_cast<double>(plan_bytes(points, 2));
  EXPECT_GT(estimate, 0.9 * (peak - fixed))
      << estimate / points << " bytes a point, " << (peak - fixed) / points;
  EXPECT_LT(estimate, 2.0 * (peak - fixed))
      << estimate / points << " bytes a point, " << (peak - fixed) / points;
}

TEST(MemoryEstimates, EqualSectionsAreShared) {
  sim::Config config = sweep_of("4", "5");
  const SweepPlan plan = plan_sweep(config);
  ASSERT_GE(plan.machines.size(), 20U);
  std::set<const void*> parts;
  std::size_t all = 0;
  for (const SweepMachine& machine : plan.machines) {
    for (const SettingsPart& part : machine.settings) {
      parts.insert(part.get());
      ++all;
    }
  }
  EXPECT_LT(4 * parts.size(), all);
}

}  // namespace
}  // namespace marti::studies
