// The laws that every kind of machine must obey: it takes each step of the log once; no ray is lost; its
// figures add up; it is deterministic; its times scale; an observer is told all and changes nothing.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <optional>
#include <ostream>

#include "processors/program/ray_tree.h"
#include "processors/replay/driven_memory.h"
#include "tests/contract/random_cases.h"
#include "tests/support/equal_results.h"
#include "tests/support/first_difference.h"
#include "tests/support/heard_references.h"
#include "tests/support/logged_samples.h"

namespace marti::processors {

using namespace cost;
using namespace flow;
using namespace machine;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

using test::expect_equal;
using test::FirstDifference;
using test::HeardReference;
using test::HeardReferences;
using test::pick;
using test::Random;
using test::TimedCase;

/// A kind of machine, and how to make a random one with a log.
struct SchemeCase {
  const char* name;
  TimedCase (*make)(Random&);

  friend std::ostream& operator<<(std::ostream& out, const SchemeCase& c) { return out << c.name; }
};

void expect_steps(const WorkLog& log, const MachineConfig& machine, const MachineResult& result) {
  const LogTotals totals = totals_of(log);
  const StepCounts steps = result.steps();
  for (std::size_t kind = 0; kind < ray_kinds; ++kind) {
    EXPECT_EQ(steps.*ray_counters[kind], static_cast<std::int64_t>(totals.rays[kind]));
  }
  EXPECT_EQ(steps.branches, static_cast<std::int64_t>(totals.branches));
  EXPECT_EQ(steps.transforms, static_cast<std::int64_t>(totals.transforms));
  EXPECT_EQ(steps.leaves, static_cast<std::int64_t>(totals.leaves));
  EXPECT_EQ(steps.tests, static_cast<std::int64_t>(totals.tests));
  const std::array<std::int64_t, 3> tests = test::tests_by_kind(log);
  EXPECT_EQ(steps.sphere_tests, tests[1]);
  EXPECT_EQ(steps.cone_tests, tests[2]);
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
  // Whether `property` throws or fails nothing for many cases.
  template <class Property>
  static void for_random_cases(const char* law, const Property& property) {
    EXPECT_TRUE(rc::check(law, [&](std::uint64_t seed) {
      Random random(seed);
      TimedCase c = GetParam().make(random);
      property(c, random);
      RC_ASSERT(!HasFailure());
    }));
  }
};

TEST_P(Schemes, TakesTheStepsOfTheLogAndItsTimesAddUp) {
  for_random_cases("steps are the log's, times add up", [](const TimedCase& c, Random& /*random*/) {
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    expect_steps(c.log, c.machine, result);
    EXPECT_GE(result.end, 0);
    if (c.machine.scheme != Scheme::image && c.log.samples > 1) {
      EXPECT_EQ(result.host.requests, std::int64_t{c.log.width} * c.log.height * c.log.samples)
          << "the host sends every sample";
    }
    for (const NodeStatistics& node : result.nodes) {
      EXPECT_EQ(sum_of(node.time), result.end);
      for (const sim::Ticks part : node.time) {
        EXPECT_GE(part, 0);
      }
    }
  });
}

TEST_P(Schemes, TouchesTheLinesThatOneNodeTouches) {
  for_random_cases("references are one node's", [](TimedCase& c, Random& /*random*/) {
    if (c.machine.build.sharing != Sharing::given) {
      return;  // nodes that build read more
    }
    const auto lines = lines_of(replay::replay(c.log, c.machine, c.options));
    c.machine.scheme = Scheme::image;
    c.machine.clusters = 1;
    c.machine.nodes = 1;
    c.machine.contexts = 1;
    EXPECT_EQ(lines, lines_of(replay::replay(c.log, c.machine)));
  });
}

TEST_P(Schemes, EveryRayEndsAndEveryContributionArrives) {
  for_random_cases("rays and contributions are conserved", [](const TimedCase& c, Random& /*random*/) {
    if (c.machine.scheme == Scheme::image) {
      return;
    }
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    std::int64_t rays = 0;
    std::int64_t contributions = 0;
    std::vector<LoggedRay> tree;
    for (std::uint32_t y = 0; y < c.log.height; ++y) {
      for (std::uint32_t x = 0; x < c.log.width; ++x) {
        for (const auto& words : test::samples_of_pixel(c.log, x, y)) {
          rays_of_sample(words, tree);
          rays += static_cast<std::int64_t>(tree.size());
          for (const LoggedRay& ray : tree) {
            bool lit = ray.parent == LoggedRay::none;  // of a pixel's own ray the result is always sent
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
  for_random_cases("deterministic", [](TimedCase& c, Random& random) {
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    c.options.step_by_step = true;
    const MachineResult stepped = replay::replay(c.log, c.machine, c.options);
    expect_equal(result, stepped);
    EXPECT_LE(result.events, stepped.events);
    c.options.step_by_step = false;
    c.options.start_seed = random() | 1U;
    expect_equal(result, replay::replay(c.log, c.machine, c.options));
  });
}

TEST_P(Schemes, ScalingEveryDurationScalesEveryTimeExactly) {
  for_random_cases("times scale", [](TimedCase& c, Random& random) {
    const MachineResult base = replay::replay(c.log, c.machine, c.options);
    const std::int64_t scale = std::array{10L, 1'000L, 1'000'003L, 1'000'000'000L}[random() % 4];
    for (sim::Clock* clock : {&c.machine.clock, &c.machine.interconnect.clock, &c.machine.banks.clock,
                              &c.machine.host.clock, &c.machine.local.clock, &c.machine.network.clock}) {
      *clock = sim::Clock::from_period(clock->period() * scale);
    }
    if (std::optional<sim::Clock>& clock = c.machine.l2.clock) {
      clock = sim::Clock::from_period(clock->period() * scale);
    }
    const bool late = c.machine.banks.dram && c.machine.banks.dram->policy == memory::DramPolicy::frfcfs;
    if (c.machine.banks.dram) {
      c.machine.banks.dram->period *= scale;
    }
    const MachineResult scaled = replay::replay(c.log, c.machine, c.options);
    EXPECT_EQ(scaled.end, base.end * scale);
    if (!late) {  // its commands are decided a tick after what they may depend on, whatever a tick is
      EXPECT_EQ(scaled.events, base.events);
    }
    for (std::size_t n = 0; n < base.nodes.size(); ++n) {
      EXPECT_EQ(scaled.nodes[n].finish, base.nodes[n].finish * scale);
      for (std::size_t i = 0; i < activities; ++i) {
        EXPECT_EQ(scaled.nodes[n].time[i], base.nodes[n].time[i] * scale);
      }
    }
  });
}

// The second level's clock is, unless it has one of its own, that of what it stands beside; and a clock that
// is so many times as fast with so many times the cycles changes nothing.
TEST_P(Schemes, TheSecondLevelHasAClockOfItsOwn) {
  for_random_cases("clock of the second level", [](TimedCase& c, Random& random) {
    MachineConfig& machine = c.machine;
    const std::int64_t times = pick(random, 2, 5);
    machine.l2.clock.reset();
    const sim::Clock beside =
        machine.l2.sharing == SecondLevel::shared ? machine.interconnect.clock : machine.clock;
    machine.l2.hit_cycles *= times;
    const MachineResult base = replay::replay(c.log, machine, c.options);
    machine.l2.clock = beside;
    expect_equal(replay::replay(c.log, machine, c.options), base);
    machine.l2.hit_cycles /= times;
    machine.l2.clock = sim::Clock::from_period(beside.period() * times);
    expect_equal(replay::replay(c.log, machine, c.options), base);
  });
}

TEST_P(Schemes, WithoutAnyCostsTheFrameTakesNoTime) {
  for_random_cases("zero latencies", [](TimedCase& c, Random& /*random*/) {
    MachineConfig& machine = c.machine;
    machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
    machine.switch_cycles = 0;
    machine.cache.hit_cycles = 0;
    machine.l2.hit_cycles = 0;
    machine.local.access_cycles = 0;
    machine.local.cycles_per_beat = 0;
    machine.interconnect.address_cycles = 0;
    machine.interconnect.cycles_per_beat = 0;
    machine.interconnect.latency_cycles = 0;
    machine.banks.access_cycles = 0;
    machine.banks.busy_cycles = 0;
    machine.banks.dram.reset();
    machine.host.latency_cycles = 0;
    machine.host.occupancy_cycles = 0;
    machine.network.hop_cycles = 0;
    machine.network.cycles_per_beat = 0;
    machine.messages.send_cycles = 0;
    machine.messages.receive_cycles = 0;
    const MachineResult result = replay::replay(c.log, machine, c.options);
    expect_steps(c.log, machine, result);
    EXPECT_EQ(result.end, 0);
  });
}

TEST_P(Schemes, MoreNodesThanRaysAndImagesOfOnePixelOrNone) {
  for_random_cases("tiny images", [](TimedCase& c, Random& random) {
    const auto size = static_cast<std::uint32_t>(pick(random, 0, 1));
    c.log = test::random_ray_trees(random, size, size, 3, 2);
    c.options.starts.clear();
    c.machine.prefetch.children = c.machine.prefetch.children && c.log.traversal < accel::Traversal::grid;
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    expect_steps(c.log, c.machine, result);
    EXPECT_TRUE(size != 0 || c.machine.scheme == Scheme::image || result.end == 0);
  });
}

// Where a node's time goes, as its account has it and as an observer is told.
constexpr std::array<std::pair<NodeState, Activity>, 7> told_as_counted = {
    {{NodeState::interconnect_wait, Activity::interconnect_wait},
     {NodeState::bank_wait, Activity::bank_wait},
     {NodeState::lock_wait, Activity::lock_wait},
     {NodeState::message_wait, Activity::message_wait},
     {NodeState::queue_full_wait, Activity::queue_full_wait},
     {NodeState::dispatch_wait, Activity::dispatch_wait},
     {NodeState::idle, Activity::idle}}};

TEST_P(Schemes, AnObserverIsToldAllOfTheTimeAndEveryMissAndChangesNothing) {
  for_random_cases("observed", [](TimedCase& c, Random& /*random*/) {
    c.options.keep_read_events = true;
    const MachineResult alone = replay::replay(c.log, c.machine, c.options);
    test::Watcher seen;
    c.options.observer = &seen;
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    expect_equal(result, alone);
    EXPECT_EQ(result.events, alone.events);
    EXPECT_EQ(seen.faults, 0);
    EXPECT_EQ(seen.ended, result.end);
    const auto of = [](const auto& parts, auto which) { return parts[static_cast<std::size_t>(which)]; };
    sim::Ticks nobodys = 0;
    for (std::size_t node = 0; node < result.nodes.size(); ++node) {
      const TimeDivision& time = result.nodes[node].time;
      EXPECT_EQ(seen.until[node], result.end);
      for (const auto& [state, activity] : told_as_counted) {
        EXPECT_EQ(of(seen.states[node], state), of(time, activity));
      }
      // Reading own memory is working.
      EXPECT_LE(of(seen.states[node], NodeState::transfer), of(time, Activity::transfer));
      EXPECT_LE(of(seen.states[node], NodeState::bank_access), of(time, Activity::bank_access));
      if (c.machine.scheme == Scheme::image && c.machine.placement == Placement::shared &&
          c.machine.build.sharing == Sharing::given) {
        EXPECT_EQ(of(seen.states[node], NodeState::transfer), of(time, Activity::transfer));
      }
      EXPECT_EQ(seen.misses[node], result.nodes[node].references.all_misses());
      nobodys +=
          of(time, Activity::dispatch_wait) + of(time, Activity::message_wait) + of(time, Activity::idle);
    }
    for (std::size_t cluster = 0; cluster < result.clusters.size(); ++cluster) {
      const replay::ClusterResult& counted = result.clusters[cluster];
      if (counted.distributed) {
        const memory::DistributedStatistics& accesses = counted.distributed->accesses;
        EXPECT_EQ(seen.asked_of[cluster].reads, accesses.local_reads + accesses.remote_reads);
        EXPECT_EQ(seen.asked_of[cluster].writes, accesses.local_writes + accesses.remote_writes);
      } else {
        EXPECT_EQ(seen.asked_of[cluster].reads, counted.interconnect.reads);
        EXPECT_EQ(seen.asked_of[cluster].writes, counted.interconnect.writes);
        EXPECT_EQ(seen.asked_of[cluster].bytes, counted.interconnect.bytes);
      }
    }
    for (const int times : seen.begun) {
      EXPECT_EQ(times, result.flow.nodes.empty() ? 1 : 0) << "where rays move, nodes have no packets";
    }
    sim::Ticks of_pixels = 0;
    for (const auto& [place, time] : seen.pixel_time) {
      of_pixels += time;
    }
    const sim::Ticks all = result.end * static_cast<sim::Ticks>(result.nodes.size());
    EXPECT_LE(of_pixels, all - nobodys);
    if (result.build.start_up == 0) {
      EXPECT_EQ(of_pixels, all - nobodys);
      EXPECT_EQ(seen.pixel_misses, result.references().all_misses());
    }
    test::Watcher stepped;
    c.options.observer = &stepped;
    c.options.step_by_step = true;
    (void)replay::replay(c.log, c.machine, c.options);
    EXPECT_EQ(seen.states, stepped.states);
    EXPECT_EQ(seen.pixel_time, stepped.pixel_time);
  });
}

// A shared memory that gets the requests of a frame at their times from a trace counts what it counted in the
// frame, where the nodes made them.
TEST_P(Schemes, WhatNodesReferToIsTold) {
  for_random_cases("references are told", [](TimedCase& c, Random& /*random*/) {
    HeardReferences heard;
    c.options.observer = &heard;
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    for (std::uint32_t node = 0; node < result.nodes.size(); ++node) {
      ReferenceCounts counts;
      std::int64_t writes = 0;
      sim::Ticks last = 0;
      heard.for_each(node, [&](const HeardReference& reference) {
        EXPECT_GE(reference.time, last);
        EXPECT_GT(reference.bytes, 0U);
        last = reference.time;
        writes += reference.write ? 1 : 0;
        if (!reference.write) {
          ++(reference.hit ? counts.hits : counts.misses)[static_cast<std::size_t>(reference.kind)];
        }
      });
      EXPECT_LE(last, result.end);
      EXPECT_EQ(counts.hits, result.nodes[node].references.hits);
      EXPECT_EQ(counts.misses, result.nodes[node].references.misses);
      EXPECT_GE(writes, c.machine.scheme == Scheme::image ? result.nodes[node].writes : 0);
    }
    c.options.observer = nullptr;
    EXPECT_EQ(FirstDifference::between(result, replay::replay(c.log, c.machine, c.options)), "");
  });
}

TEST_P(Schemes, AMemoryDrivenByWhatItsNodesAskedForDoesWhatItDid) {
  class Listener final : public processors::walk::Observer {
   public:
    void spent(std::uint32_t, NodeState, sim::Ticks, sim::Ticks, PixelPlace) override {}
    [[nodiscard]] bool hears_requests() const override { return true; }
    void requested(const walk::Request& request) override { requests.push_back(request); }
    std::vector<walk::Request> requests;
  };
  for_random_cases("driven", [](TimedCase& c, Random& /*random*/) {
    if (c.machine.clusters != 1 || c.machine.placement != Placement::shared ||
        c.machine.ports_of_node() != 1 || c.machine.scheme == Scheme::space) {
      return;
    }
    Listener heard;
    c.options.observer = &heard;
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    std::size_t at = 0;
    const replay::DrivenResult driven =
        replay::drive_memory(c.machine, {.outstanding = 1}, [&](replay::DrivenRequest& request) {
          if (at == heard.requests.size()) {
            return false;
          }
          request = {heard.requests[at++]};
          return true;
        });
    EXPECT_EQ(driven.late, 0);
    EXPECT_EQ(driven.latency.count, result.clusters[0].interconnect.reads);
    EXPECT_LE(driven.machine.end, result.end);
    const replay::ClusterResult& found = driven.machine.clusters[0];
    for (const auto& counter : memory::InterconnectStatistics::counters()) {
      EXPECT_EQ(counter.value(found.interconnect), counter.value(result.clusters[0].interconnect))
          << counter.name;
    }
    ASSERT_EQ(found.banks.size(), result.clusters[0].banks.size());
    for (std::size_t bank = 0; bank < found.banks.size(); ++bank) {
      EXPECT_EQ(found.banks[bank].accesses, result.clusters[0].banks[bank].accesses);
      EXPECT_EQ(found.banks[bank].waits.sum, result.clusters[0].banks[bank].waits.sum);
    }
  });
}

// With the caches of its nodes before it: driven by what they referred to, it and they do what they did.
TEST_P(Schemes, CachesDrivenByWhatTheirNodesReferredToDoWhatTheyDid) {
  for_random_cases("driven caches", [](TimedCase& c, Random& /*random*/) {
    if (c.machine.clusters != 1 || c.machine.placement != Placement::shared ||
        c.machine.ports_of_node() != 1 || c.machine.scheme == Scheme::space ||
        c.machine.build.sharing != Sharing::given ||
        c.machine.cache.organisation == CacheOrganisation::none) {
      return;
    }
    HeardReferences heard;
    c.options.observer = &heard;
    const MachineResult result = replay::replay(c.log, c.machine, c.options);
    std::vector<HeardReference> all;
    for (std::uint32_t node = 0; node < c.machine.nodes; ++node) {
      heard.for_each(node, [&](const HeardReference& reference) { all.push_back(reference); });
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const HeardReference& a, const HeardReference& b) { return a.time < b.time; });
    std::size_t at = 0;
    const replay::DrivenResult driven = replay::drive_memory(c.machine, {.outstanding = 1, .caches = true},
                                                             [&](replay::DrivenRequest& request) {
                                                               if (at == all.size()) {
                                                                 return false;
                                                               }
                                                               request = {all[at], all[at].kind};
                                                               ++at;
                                                               return true;
                                                             });
    const ReferenceCounts references = result.references();
    EXPECT_EQ(driven.references.hits, references.hits);
    EXPECT_EQ(driven.references.misses, references.misses);
    EXPECT_EQ(driven.machine.clusters[0].interconnect.reads, result.clusters[0].interconnect.reads);
    EXPECT_EQ(driven.machine.clusters[0].interconnect.writes, result.clusters[0].interconnect.writes);
    if (c.machine.l2.sharing == SecondLevel::private_caches) {
      EXPECT_EQ(driven.machine.l2.counters().hits, result.l2.counters().hits);
    }
  });
}

INSTANTIATE_TEST_SUITE_P(All, Schemes,
                         ::testing::Values(SchemeCase{"image", test::image_case},
                                           SchemeCase{"contexts", test::contexts_case},
                                           SchemeCase{"idle_contexts", test::idle_contexts_case},
                                           SchemeCase{"building", test::building_case},
                                           SchemeCase{"building_contexts", test::building_contexts_case},
                                           SchemeCase{"pipeline", test::pipeline_case},
                                           SchemeCase{"space", test::space_case}),
                         [](const auto& a_case) { return std::string(a_case.param.name); });

}  // namespace
}  // namespace marti::processors
