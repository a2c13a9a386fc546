// Features that combine: a machine with any two of them runs, keeps the laws that every replay checks and
// does not depend on how events are posted; contexts and prefetching do what a plain implementation does. A
// pair that does not combine is refused, and the message names the keys of both.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "processors/machine/combinations.h"
#include "processors/replay/replay.h"
#include "sim/key_error.h"
#include "tests/support/equal_results.h"
#include "tests/support/first_difference.h"
#include "tests/support/long_tests.h"
#include "tests/support/naive_simt.h"
#include "tests/support/random_flow.h"
#include "tests/support/user_error.h"
#include "tests/unit/processors/naive_contexts.h"

namespace marti::processors {

using namespace machine;
using namespace program;
using namespace replay;

namespace {

using test::pick;
using test::Random;

void ask_for(Random& random, Feature feature, bool tree, MachineConfig& machine) {
  switch (feature) {
    case Feature::contexts:
      machine.contexts = static_cast<std::uint32_t>(pick(random, 2, 5));
      machine.switch_cycles = pick(random, 0, 6);
      break;
    case Feature::prefetch:
      machine.prefetch.children = tree && random() % 2 == 0;
      machine.prefetch.next_line = !machine.prefetch.children || random() % 2 == 0;
      machine.prefetch.outstanding = static_cast<std::uint32_t>(pick(random, 1, 4));
      break;
    case Feature::building:
      machine.build = test::random_build(random);
      break;
    case Feature::distributed:
      machine.placement = Placement::distributed;
      break;
    case Feature::private_second_level:
      machine.l2.sharing = SecondLevel::private_caches;
      break;
    case Feature::counting:
      machine.count = {random() % 2 == 0, random() % 2 == 0, random() % 2 == 0};
      machine.count.attribution = machine.count.attribution || !machine.count.any();
      break;
    case Feature::simt:
      machine.kind = NodeKind::simt;
      machine.simt.lanes = static_cast<std::uint32_t>(pick(random, 1, 16));
      machine.simt.warps = static_cast<std::uint32_t>(pick(random, 1, 4));
      machine.simt.mshrs = static_cast<std::uint32_t>(pick(random, 1, 8));
      machine.rt.warps = static_cast<std::uint32_t>(pick(random, 0, 3));
      break;
    case Feature::moving_rays:
      random() % 2 == 0 ? test::make_random_pipeline(random, machine)
                        : test::make_random_space(random, machine);
      break;
  }
}

struct Case {
  WorkLog log;
  MachineConfig machine;
};

// The log with a ray before each visit that follows none, as the tracer writes logs: a lane of a SIMT node
// traces rays.
WorkLog with_rays(const WorkLog& log) {
  WorkLog all = log;
  for (LogRow& row : all.rows) {
    const LogRow before = row;
    row = {};
    for (std::uint32_t x = 0; x < log.width; ++x) {
      row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
      bool traces = false;
      const std::uint32_t* word = before.words.data() + before.begin[x];
      const std::uint32_t* const end = before.words.data() + before.begin[x + 1];
      while (word != end) {
        const Step step = step_of(*word);
        const bool visit = visits_node(step) || step == Step::pass;
        if (visit && !traces) {
          row.words.push_back(camera_ray);
        }
        traces = visit || step == Step::ray;
        row.words.insert(row.words.end(), word, word + step_words(word));
        word += step_words(word);
      }
    }
    row.begin.push_back(static_cast<std::uint32_t>(row.words.size()));
  }
  return all;
}

// A random machine that has these two features and, of the others, none.
Case machine_with(Random& random, Feature first, Feature second) {
  Case c{test::random_log_with_tree(random), test::random_machine(random, 6)};
  if (first == Feature::simt || second == Feature::simt) {
    while (c.log.mailboxes) {
      c.log = test::random_log_with_tree(random);
    }
    c.log = with_rays(c.log);
  }
  MachineConfig& machine = c.machine;
  machine.placement = random() % 4 == 0 ? Placement::replicated : Placement::shared;
  if (machine.cache.organisation == CacheOrganisation::none) {
    machine.cache.organisation = CacheOrganisation::unified;
    machine.distribution.interleave = std::max(machine.distribution.interleave, machine.cache.cache.line);
  }
  test::add_random_second_level(random, machine);
  machine.l2.sharing = SecondLevel::none;
  for (memory::CacheConfig* const cache : {&machine.cache.cache, &machine.l2.cache}) {
    cache->replacement = random() % 2 == 0 ? memory::Replacement::lru : memory::Replacement::fifo;
  }
  // Moving rays first: it decides the placement.
  const bool tree = c.log.traversal < accel::Traversal::grid;
  ask_for(random, std::max(first, second), tree, machine);
  ask_for(random, std::min(first, second), tree, machine);
  if (machine.prefetch.on() && machine.placement == Placement::replicated) {
    machine.placement = Placement::shared;
  }
  if (machine.build.sharing == Sharing::shared) {
    machine.interconnect.arbitration = memory::Arbitration::fifo;
    if (machine.placement == Placement::replicated) {
      machine.build.sharing = Sharing::private_trees;
    }
  }
  return c;
}

bool is_refused(const MachineConfig& machine) {
  return std::ranges::any_of(refused_pairs(),
                             [&](const RefusedPair& pair) { return is_refused(machine, pair); });
}

void expect_as_naive(const WorkLog& log, const MachineConfig& machine, const MachineResult& result) {
  test::NaiveCounts counts(machine);
  MachineResult plain = test::NaiveContexts(log, machine, &counts).run();
  if (result.contexts.nodes.empty()) {
    plain.contexts.nodes.clear();
  }
  for (std::size_t node = 0; node < plain.nodes.size(); ++node) {
    plain.nodes[node].steps = result.nodes[node].steps;  // which it does not count
  }
  test::expect_equal(result, plain);
  counts.expect(result.counts, true);
}

class Pairs : public ::testing::TestWithParam<std::pair<std::size_t, std::size_t>> {
 protected:
  static Feature first() { return static_cast<Feature>(GetParam().first); }
  static Feature second() { return static_cast<Feature>(GetParam().second); }
};

TEST_P(Pairs, RunsOrIsRefusedWithTheKeysOfBoth) {
  for (std::uint64_t seed = 1; seed <= test::cases(60U) && !HasFailure(); ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const auto [log, machine] = machine_with(random, first(), second());
    ASSERT_TRUE(has(machine, first()) && has(machine, second()));
    if (is_refused(machine)) {
      const std::string message =
          test::user_error_of<sim::KeyError>([&] { (void)replay::replay(log, machine); });
      for (const Feature feature : {first(), second()}) {
        EXPECT_NE(message.find(key_of(machine, feature)), std::string::npos) << message;
      }
      continue;
    }
    const MachineResult result = replay::replay(log, machine);
    for (const ReplayOptions& options : {ReplayOptions{.step_by_step = true}, {.start_seed = seed}}) {
      const MachineResult other = replay::replay(log, machine, options);
      test::expect_equal(result, other);
      test::expect_equal_counts(result.counts, other.counts);
    }
    MachineConfig uncounted = machine;
    uncounted.count = {};
    test::expect_equal(result, replay::replay(log, uncounted));
    if (machine.kind == NodeKind::simt) {
      if (seed > test::cases(12U)) {
        continue;  // every cycle of every node takes time
      }
      EXPECT_EQ(test::FirstDifference::between(result, test::naive_simt(log, machine)), "");
    } else if (machine.scheme == Scheme::image && machine.build.sharing == Sharing::given) {
      expect_as_naive(log, machine, result);
    }
  }
}

std::vector<std::pair<std::size_t, std::size_t>> all_pairs() {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t first = 0; first < features; ++first) {
    for (std::size_t second = first + 1; second < features; ++second) {
      pairs.emplace_back(first, second);
    }
  }
  return pairs;
}

std::string name_of(std::size_t first, std::size_t second) {
  std::string name =
      std::string(feature_texts[first].name) + " and " + std::string(feature_texts[second].name);
  std::ranges::replace(name, ' ', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Pairs, ::testing::ValuesIn(all_pairs()),
                         [](const auto& pair) { return name_of(pair.param.first, pair.param.second); });

TEST(Combinations, NoPairIsListedTwiceAndEveryReasonIsGiven) {
  const auto pairs = refused_pairs();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    EXPECT_LT(pairs[i].first, pairs[i].second);
    EXPECT_FALSE(pairs[i].reason.empty());
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_FALSE(pairs[i].first == pairs[j].first && pairs[i].second == pairs[j].second);
    }
  }
}

}  // namespace
}  // namespace marti::processors
