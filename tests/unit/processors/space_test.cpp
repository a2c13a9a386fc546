// The space scheme against a second model and against laws. The laws of all machines are in tests/contract.
#include "processors/replay/space.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <algorithm>

#include "processors/cost/step_time.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/naive_space.h"
#include "tests/support/random_flow.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace flow;
using namespace machine;
using namespace program;
using namespace replay;

namespace {

MachineConfig random_space(test::Random& random) {
  MachineConfig machine = test::random_machine(random, 9);
  test::make_random_space(random, machine);
  if (random() % 8 == 0) {
    // Nothing takes any time: all events are at the same tick.
    machine.operations = {0, 0, 0, 0, 0, 0, 0, 0};
    machine.cache.hit_cycles = machine.local.access_cycles = machine.local.cycles_per_beat = 0;
    machine.messages.send_cycles = machine.messages.receive_cycles = 0;
    machine.network.cycles_per_beat = machine.network.hop_cycles = 0;
    machine.host.latency_cycles = machine.host.occupancy_cycles = 0;
  }
  return machine;
}

RC_GTEST_PROP(Space, EqualsASecondModelInEveryCounter, (std::uint64_t seed)) {
  test::Random random(seed);
  for (int repeat = 0; repeat < 4; ++repeat) {
    const WorkLog log = test::any_log(random, false);
    MachineConfig machine = random_space(random);
    if (machine.cache.cache.replacement == memory::Replacement::random) {
      machine.cache.cache.replacement = memory::Replacement::fifo;
    }
    machine.count = {machine.cache.organisation != CacheOrganisation::none, true, true};
    const MachineResult result = replay::replay(log, machine);
    test::NaiveCounts counts(machine);
    MachineResult plain = test::NaiveSpace(log, machine, &counts).run();
    counts.expect(result.counts, true);
    test::expect_equal(replay::replay(log, test::without_counting(machine)), result);
    plain.clusters = result.clusters;  // no node uses a memory that is shared
    test::expect_equal(result, plain);
    RC_ASSERT(!::testing::Test::HasFailure());
  }
}

TEST(Space, ImpossibleMachinesAreRefused) {
  test::Random random(1);
  const WorkLog log = test::random_tree_log(random, 2, 2);
  const auto refusal_of = [&](void (*spoil)(MachineConfig&)) {
    MachineConfig machine;
    machine.scheme = Scheme::space;
    spoil(machine);
    return test::user_error_of([&] { (void)replay::replay(log, machine); });
  };
  EXPECT_EQ(refusal_of([](MachineConfig& m) { m.space.level = 0; }), "space.level: the root is level 1");
  EXPECT_NE(refusal_of([](MachineConfig& m) { m.space.queue = 0; }).find("space.queue"), std::string::npos);
  EXPECT_NE(refusal_of([](MachineConfig& m) { m.local.width = 0; }).find("local memory"), std::string::npos);
}

}  // namespace
}  // namespace marti::processors
