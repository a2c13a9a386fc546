// The laws that every parallel scheme must obey on every machine: it takes each step of the log once; no
// ray is lost; its figures add up; it is deterministic.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <ostream>

#include "processors/program/ray_tree.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/logged_samples.h"
#include "tests/support/random_flow.h"

namespace marti::processors {
namespace {

using test::expect_equal;
using test::pick;
using test::Random;

/// A scheme and how to make a random machine one of it.
struct SchemeCase {
  Scheme scheme;
  void (*choose)(Random&, MachineConfig&);

  friend std::ostream& operator<<(std::ostream& out, const SchemeCase& c) {
    return out << scheme_names[static_cast<std::size_t>(c.scheme)];
  }
};

void keep_image(Random& /*random*/, MachineConfig& machine) { machine.scheme = Scheme::image; }

MachineConfig machine_of(Random& random, const SchemeCase& scheme) {
  MachineConfig machine = test::random_machine(random);
  scheme.choose(random, machine);
  test::add_random_second_level(random, machine);
  if (machine.scheme == Scheme::space && machine.l2.sharing == SecondLevel::shared) {
    machine.l2.sharing = SecondLevel::none;  // there is no shared memory behind it
  }
  return machine;
}

WorkLog any_log(Random& random) {
  const auto width = static_cast<std::uint32_t>(pick(random, 1, 8));
  const auto height = static_cast<std::uint32_t>(pick(random, 1, 8));
  switch (pick(random, 0, 3)) {
    case 0:
      return test::random_log(random, width, height);
    case 1:
      return test::random_tree_log(random, width, height);
    case 2:
      return test::random_ray_trees(random, width, height, 12, 4);
    default:
      return test::random_ray_trees(random, width, height, 5, 4,
                                    static_cast<std::uint32_t>(pick(random, 2, 5)));
  }
}

void expect_steps(const WorkLog& log, const MachineConfig& machine, const MachineResult& result) {
  const LogTotals totals = totals_of(log);
  const StepCounts steps = result.steps();
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    EXPECT_EQ(steps.*ray_counters[kind], static_cast<std::int64_t>(totals.rays[kind]));
  }
  EXPECT_EQ(steps.branches, static_cast<std::int64_t>(totals.branches));
  EXPECT_EQ(steps.leaves, static_cast<std::int64_t>(totals.leaves));
  EXPECT_EQ(steps.tests, static_cast<std::int64_t>(totals.tests));
  EXPECT_EQ(steps.lookups, static_cast<std::int64_t>(totals.lookups));
  EXPECT_EQ(steps.shades, static_cast<std::int64_t>(totals.shades));
  EXPECT_EQ(steps.lights, static_cast<std::int64_t>(totals.lights));
  EXPECT_EQ(steps.texels, static_cast<std::int64_t>(totals.texels));
  EXPECT_EQ(steps.cuts, static_cast<std::int64_t>(totals.cuts));
  EXPECT_EQ(steps.passes, static_cast<std::int64_t>(totals.passes));
  EXPECT_EQ(steps.pixels, machine.scheme == Scheme::image ? std::int64_t{log.width} * log.height : 0);
}

// Lines touched of each kind of record; without a cache every one is a miss.
std::array<std::int64_t, memory::record_kinds> lines_of(const MachineResult& result) {
  const ReferenceCounts references = result.references();
  std::array<std::int64_t, memory::record_kinds> lines{};
  for (std::size_t kind = 0; kind < memory::record_kinds; ++kind) {
    lines[kind] = references.hits[kind] + references.misses[kind];
  }
  return lines;
}

class Schemes : public ::testing::TestWithParam<SchemeCase> {
 protected:
  // Whether `holds` throws or fails nothing for many seeds.
  template <class Property>
  static void for_random_seeds(const char* law, const Property& property) {
    EXPECT_TRUE(rc::check(law, [&](std::uint64_t seed) {
      Random random(seed);
      property(random);
      RC_ASSERT(!HasFailure());
    }));
  }
};

TEST_P(Schemes, TakesTheStepsOfTheLogAndItsTimesAddUp) {
  for_random_seeds("steps are the log's, times add up", [](Random& random) {
    const WorkLog log = any_log(random);
    const MachineConfig machine = machine_of(random, GetParam());
    const MachineResult result = replay(log, machine);
    expect_steps(log, machine, result);
    EXPECT_GE(result.end, 0);
    for (const NodeStatistics& node : result.nodes) {
      EXPECT_EQ(sum_of(node.time), result.end);
      for (const sim::Ticks part : node.time) {
        EXPECT_GE(part, 0);
      }
    }
  });
}

TEST_P(Schemes, TouchesTheLinesThatOneNodeTouches) {
  for_random_seeds("references are one node's", [](Random& random) {
    const WorkLog log = any_log(random);
    MachineConfig machine = machine_of(random, GetParam());
    const auto lines = lines_of(replay(log, machine));
    machine.scheme = Scheme::image;
    machine.clusters = 1;
    machine.nodes = 1;
    EXPECT_EQ(lines, lines_of(replay(log, machine)));
  });
}

TEST_P(Schemes, EveryRayEndsAndEveryContributionArrives) {
  for_random_seeds("rays and contributions are conserved", [](Random& random) {
    const WorkLog log = any_log(random);
    const MachineConfig machine = machine_of(random, GetParam());
    const MachineResult result = replay(log, machine);
    if (machine.scheme == Scheme::image) {
      return;
    }
    std::int64_t rays = 0;
    std::int64_t contributions = 0;
    std::vector<LoggedRay> tree;
    for (std::uint32_t y = 0; y < log.height; ++y) {
      for (std::uint32_t x = 0; x < log.width; ++x) {
        for (const auto& words : test::samples_of_pixel(log, x, y)) {
          rays_of_sample(words, tree);
          rays += static_cast<std::int64_t>(tree.size());
          for (const LoggedRay& ray : tree) {
            bool lit = false;
            for (const std::uint32_t* word = ray.begin; word != ray.end; word += step_words(word)) {
              lit = lit || step_of(*word) == Step::light;
            }
            contributions += ray.kind != RayKind::shadow || lit ? 1 : 0;
          }
        }
      }
    }
    EXPECT_EQ(result.flow.rays, rays);
    EXPECT_EQ(result.flow.collected, contributions);
    std::int64_t ended = 0;
    for (const FlowCounts& node : result.flow.nodes) {
      ended += node.ended;
    }
    EXPECT_EQ(ended, rays);
  });
}

TEST_P(Schemes, RunningAheadAndTheOrderOfTheFirstEventsChangeNothing) {
  for_random_seeds("deterministic", [](Random& random) {
    const WorkLog log = any_log(random);
    const MachineConfig machine = machine_of(random, GetParam());
    const MachineResult result = replay(log, machine);
    expect_equal(result, replay(log, machine, {.step_by_step = true}));
    expect_equal(result, replay(log, machine, {.start_seed = random() | 1U}));
  });
}

TEST_P(Schemes, WithoutAnyCostsTheFrameTakesNoTime) {
  for_random_seeds("zero latencies", [](Random& random) {
    const WorkLog log = any_log(random);
    MachineConfig machine = machine_of(random, GetParam());
    machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
    machine.cache.hit_cycles = 0;
    machine.l2.hit_cycles = 0;
    machine.local.access_cycles = 0;
    machine.local.cycles_per_beat = 0;
    machine.interconnect.address_cycles = 0;
    machine.interconnect.cycles_per_beat = 0;
    machine.interconnect.latency_cycles = 0;
    machine.banks.access_cycles = 0;
    machine.banks.busy_cycles = 0;
    machine.host.latency_cycles = 0;
    machine.host.occupancy_cycles = 0;
    machine.network.hop_cycles = 0;
    machine.network.cycles_per_beat = 0;
    machine.messages.send_cycles = 0;
    machine.messages.receive_cycles = 0;
    const MachineResult result = replay(log, machine);
    expect_steps(log, machine, result);
    EXPECT_EQ(result.end, 0);
  });
}

TEST_P(Schemes, MoreNodesThanRaysAndImagesOfOnePixelOrNone) {
  for_random_seeds("tiny images", [](Random& random) {
    const auto size = static_cast<std::uint32_t>(pick(random, 0, 1));
    const WorkLog log = test::random_ray_trees(random, size, size, 3, 2);
    const MachineConfig machine = machine_of(random, GetParam());
    const MachineResult result = replay(log, machine);
    expect_steps(log, machine, result);
    EXPECT_TRUE(size != 0 || machine.scheme == Scheme::image || result.end == 0);
  });
}

INSTANTIATE_TEST_SUITE_P(All, Schemes,
                         ::testing::Values(SchemeCase{Scheme::image, keep_image},
                                           SchemeCase{Scheme::pipeline, test::make_random_pipeline},
                                           SchemeCase{Scheme::space, test::make_random_space}),
                         [](const auto& a_case) { return ::testing::PrintToString(a_case.param); });

}  // namespace
}  // namespace marti::processors
