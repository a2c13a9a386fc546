// The pipeline against a second implementation, against closed forms, and where it could deadlock.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "processors/flow/load_order.h"
#include "processors/flow/pipeline/stages.h"
#include "processors/replay/replay.h"
#include "sim/error.h"
#include "tests/support/equal_results.h"
#include "tests/support/naive_pipeline.h"
#include "tests/support/random_flow.h"
#include "tests/support/user_error.h"

namespace marti::processors {

using namespace cost;
using namespace flow;
using namespace machine;
using namespace program;
using namespace replay;

namespace {

using test::pick;
using test::Random;

sim::Ticks part(const NodeStatistics& node, Activity activity) {
  return node.time[static_cast<std::size_t>(activity)];
}

// One cluster with the database in each node: nothing is shared but queues and network.
MachineConfig machine_without_shared_memory(Random& random) {
  MachineConfig machine = test::random_machine(random);
  test::make_random_pipeline(random, machine);
  machine.clusters = 1;
  machine.placement = Placement::replicated;
  if (machine.cache.cache.replacement == memory::Replacement::random) {
    machine.cache.cache.replacement = memory::Replacement::fifo;  // victims are drawn for each node anew
  }
  machine.local.width = static_cast<std::uint32_t>(pick(random, 1, 16));
  machine.local.cycles_per_beat = pick(random, 0, 2);
  return machine;
}

void expect_equal(const test::NaivePipeline& naive, const MachineResult& result) {
  ASSERT_EQ(naive.end, result.end);
  ASSERT_EQ(naive.nodes.size(), result.nodes.size());
  for (std::size_t n = 0; n < naive.nodes.size(); ++n) {
    const test::NaivePipeline::Node& expected = naive.nodes[n];
    const NodeStatistics& node = result.nodes[n];
    EXPECT_EQ(expected.finish, node.finish) << "node " << n;
    EXPECT_EQ(expected.message_wait, part(node, Activity::message_wait));
    EXPECT_EQ(expected.queue_full_wait, part(node, Activity::queue_full_wait));
    EXPECT_EQ(expected.messaging, part(node, Activity::messaging));
    EXPECT_EQ(expected.served, part(node, Activity::traversal) + part(node, Activity::intersection) +
                                   part(node, Activity::shading) + part(node, Activity::cache_access) +
                                   part(node, Activity::transfer) + part(node, Activity::bank_access));
    const FlowCounts& counts = result.flow.nodes[n];
    EXPECT_EQ(expected.counts.taken, counts.taken);
    EXPECT_EQ(expected.counts.made, counts.made);
    EXPECT_EQ(expected.counts.passed_on, counts.passed_on);
    EXPECT_EQ(expected.counts.ended, counts.ended);
    EXPECT_EQ(expected.counts.contributions, counts.contributions);
    EXPECT_EQ(expected.counts.queued, counts.queued);
    EXPECT_EQ(expected.counts.longest_queue, counts.longest_queue);
    EXPECT_EQ(expected.counts.most_set_aside, counts.most_set_aside);
  }
  EXPECT_EQ(naive.most_in_flight_seen, result.flow.most_in_flight);
  EXPECT_EQ(naive.network().busy, result.flow.networks[0].busy);
  EXPECT_EQ(naive.network().waits.sum, result.flow.networks[0].waits.sum);
}

RC_GTEST_PROP(Pipeline, EqualsASecondImplementation, (std::uint64_t seed)) {
  Random random(seed);
  const auto side = static_cast<std::uint32_t>(pick(random, 1, 7));
  const WorkLog log =
      pick(random, 0, 1) == 0
          ? test::random_log(random, side, side)
          : test::random_ray_trees(random, side, side, 15, 4, static_cast<std::uint32_t>(pick(random, 1, 4)));
  MachineConfig machine = machine_without_shared_memory(random);
  machine.count = {machine.cache.organisation != CacheOrganisation::none, true, true};
  const MachineResult result = replay::replay(log, machine);
  test::NaiveCounts counts(machine);
  expect_equal(test::NaivePipeline(log, machine, &counts), result);
  counts.expect(result.counts, true);
  test::expect_equal(replay::replay(log, test::without_counting(machine)), result);
  RC_ASSERT(!::testing::Test::HasFailure());
}

RC_GTEST_PROP(Pipeline, QueuesOfOneAndAnyNumberInFlightNeverDeadlock, (std::uint64_t seed)) {
  Random random(seed);
  const WorkLog log = test::random_ray_trees(random, 4, 4, 60, 8);
  MachineConfig machine = test::random_machine(random);
  test::make_random_pipeline(random, machine);
  if (pick(random, 0, 1) == 0) {
    machine.pipeline.search = 1;
    machine.pipeline.nearest = 1;
    machine.pipeline.shade = 1;
    machine.nodes = 3;
  }
  machine.pipeline.queue = 1;
  // replay() itself checks that nothing is left over.
  machine.pipeline.in_flight = 0;
  const MachineResult most = replay::replay(log, machine);
  RC_ASSERT(most.flow.most_in_flight <= std::int64_t{machine.clusters} * most_in_flight(machine.pipeline));
  machine.pipeline.in_flight = 1;
  RC_ASSERT(replay::replay(log, machine).flow.most_in_flight <= std::int64_t{machine.clusters});
}

void expect_refused(const WorkLog& log, const MachineConfig& machine, const std::string& why) {
  const std::string message = test::user_error_of([&] { (void)replay::replay(log, machine); });
  EXPECT_NE(message.find(why), std::string::npos) << message;
}

TEST(Pipeline, RefusesWhatCannotBeBuilt) {
  Random random(3);
  const WorkLog log = test::random_ray_trees(random, 2, 2, 3, 2);
  MachineConfig machine;
  machine.scheme = Scheme::pipeline;
  machine.nodes = 2;
  expect_refused(log, machine, "machine.nodes");
  machine.nodes = 5;
  machine.pipeline.search = 3;
  machine.pipeline.nearest = 1;
  machine.pipeline.shade = 2;
  expect_refused(log, machine, "3 + 1 + 2 = 6");
  machine.pipeline.shade = 1;
  machine.pipeline.queue = 0;
  expect_refused(log, machine, "pipeline.queue");
  machine.pipeline.queue = 2;
  machine.pipeline.in_flight = 12;
  expect_refused(log, machine, "more than 11");
  machine.pipeline.in_flight = 11;
  EXPECT_GT(replay::replay(log, machine).end, 0);
  machine.build.sharing = Sharing::none;
  expect_refused(log, machine, "build.sharing");
}

TEST(Pipeline, SharesOfAnyNumberOfNodesAreStagesOfAtLeastOne) {
  for (std::uint32_t nodes = 3; nodes < 400; ++nodes) {
    const PipelineConfig shares = default_stages(nodes);
    EXPECT_GE(shares.search, 1U);
    EXPECT_GE(shares.nearest, 1U);
    EXPECT_GE(shares.shade, 1U);
    EXPECT_EQ(shares.search + shares.nearest + shares.shade, nodes);
  }
  const PipelineConfig defaults;
  const PipelineConfig shares = default_stages(16);
  EXPECT_EQ(shares.search, defaults.search);
  EXPECT_EQ(shares.nearest, defaults.nearest);
  EXPECT_EQ(shares.shade, defaults.shade);
}

RC_GTEST_PROP(Pipeline, TheLeastLoadedNodeIsFound, (std::uint64_t seed)) {
  Random random(seed);
  const auto nodes = static_cast<std::uint32_t>(pick(random, 1, 9000));
  LoadOrder order(nodes);
  std::vector<std::uint32_t> loads(nodes, 0);
  for (int i = 0; i < 200; ++i) {
    const auto node = static_cast<std::uint32_t>(random() % nodes);
    loads[node] = pick(random, 0, 4) == 0 ? LoadOrder::none : static_cast<std::uint32_t>(pick(random, 0, 9));
    order.set(node, loads[node]);
    const auto least = std::min_element(loads.begin(), loads.end());
    RC_ASSERT(
        order.least() ==
        (*least == LoadOrder::none ? LoadOrder::none : static_cast<std::uint32_t>(least - loads.begin())));
  }
}

}  // namespace
}  // namespace marti::processors
