// Work that a replay leaves out does not change its result: against the same replay with everything kept.
#include "processors/walk/left_out.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <bit>

#include "memory/line_set.h"
#include "memory/tags.h"
#include "processors/replay/replay.h"
#include "tests/support/equal_results.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace machine;
using namespace program;
using namespace replay;
using namespace walk;

namespace {

constexpr ReplayOptions everything = {.keep_lookups = true, .keep_read_events = true};

// A machine whose caches may hold all of a random log's database and whose reads may be free of waiting.
MachineConfig roomy_machine(test::Random& random) {
  MachineConfig machine = test::random_machine(random);
  if (test::pick(random, 0, 3) != 0) {
    machine.cache.organisation = CacheOrganisation::unified;
    memory::CacheConfig& cache = machine.cache.cache;
    cache.ways = std::bit_floor(std::max(1U, cache.ways));
    cache.size = std::bit_ceil(std::uint64_t{cache.line} * cache.ways) << test::pick(random, 4, 12);
    machine.banks.interleave = cache.line;
    machine.distribution.interleave = cache.line;
  }
  if (test::pick(random, 0, 1) == 1) {
    machine.interconnect.kind = memory::InterconnectKind::ideal;
  }
  if (test::pick(random, 0, 2) == 0) {
    test::add_random_second_level(random, machine);
  }
  return machine;
}

RC_GTEST_PROP(LeftOut, ChangesNoResult, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::small_log(random);
  const MachineConfig machine = roomy_machine(random);
  const MachineResult less = replay::replay(log, machine);
  const MachineResult all = replay::replay(log, machine, everything);
  test::expect_equal(less, all);
  RC_ASSERT(!::testing::Test::HasFatalFailure());
  RC_ASSERT(!all.left_out.lookups && !all.left_out.read_events);
  RC_ASSERT(less.left_out.read_events == (why_read_events(machine) == nullptr));
  RC_ASSERT(!less.left_out.read_events || less.events <= all.events);
  RC_CLASSIFY(less.left_out.lookups);
  RC_CLASSIFY(less.left_out.read_events);
  RC_CLASSIFY(less.left_out.lookups && !less.l2.caches.empty());
}

// The decision about caches is exact: with one line more than is proved to fit, some order of references
// replaces a line.
RC_GTEST_PROP(LeftOut, CachesThatHoldAllReplaceNothingAndOthersDo, (std::uint64_t seed)) {
  test::Random random(seed);
  const memory::CacheShape shape = {static_cast<std::uint32_t>(test::pick(random, 1, 9)),
                                    1U << test::pick(random, 0, 3), 2};
  const auto policy = static_cast<memory::Replacement>(test::pick(random, 0, 4));
  const auto lines = static_cast<std::uint32_t>(shape.lines());
  RC_ASSERT(memory::holds_all(shape, lines));
  RC_ASSERT(!memory::holds_all(shape, lines + 1));
  memory::with_tag_store(policy, shape, [&]<class Tags>() {
    Tags tags(shape, 2, seed);
    memory::LineSet set(lines, 2);
    for (int i = 0; i < 200; ++i) {
      const auto cache = static_cast<std::uint32_t>(test::pick(random, 0, 1));
      const auto line = static_cast<std::uint32_t>(test::pick(random, 0, lines - 1));
      RC_ASSERT(set.access(cache, line) == tags.view(cache).access(line));
    }
    Tags full(shape, 1, seed);
    for (std::uint32_t line = 0; line <= lines; ++line) {
      (void)full.view(0).access(line);
    }
    std::uint32_t there = 0;
    for (std::uint32_t line = 0; line <= lines; ++line) {
      there += full.view(0).holds(line) ? 1 : 0;
    }
    RC_ASSERT(there == lines);
  });
}

TEST(LeftOut, WhatIsNotKnownBeforehandIsSimulated) {
  MachineConfig machine;
  machine.interconnect.kind = memory::InterconnectKind::ideal;
  EXPECT_EQ(why_read_events(machine), nullptr);
  const auto refused = [&](auto change) {
    MachineConfig other = machine;
    change(other);
    return why_read_events(other) != nullptr;
  };
  EXPECT_TRUE(refused([](MachineConfig& m) { m.interconnect.kind = memory::InterconnectKind::bus; }));
  EXPECT_TRUE(refused([](MachineConfig& m) { m.scheme = Scheme::pipeline; }));
  EXPECT_TRUE(refused([](MachineConfig& m) { m.contexts = 2; }));
  EXPECT_TRUE(refused([](MachineConfig& m) { m.build.sharing = Sharing::shared; }));
  EXPECT_TRUE(refused([](MachineConfig& m) { m.count.attribution = true; }));
  EXPECT_TRUE(refused([](MachineConfig& m) { m.l2.sharing = SecondLevel::private_caches; }));
  EXPECT_TRUE(refused([](MachineConfig& m) { m.placement = Placement::replicated; }));
}

}  // namespace
}  // namespace marti::processors
