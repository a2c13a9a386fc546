// Closed networks against a second way to solve them; bounds of timed frames.
#include "processors/replay/bounds.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "sim/error.h"
#include "tests/support/random_machine.h"

namespace marti::processors {

using namespace machine;
using namespace program;
using namespace replay;
using namespace theory;

namespace {

ClosedNetwork random_network(test::Random& random) {
  ClosedNetwork network;
  network.customers = static_cast<std::uint64_t>(test::pick(random, 1, 30));
  network.think = static_cast<double>(test::pick(random, 0, 50));
  for (std::int64_t left = test::pick(random, 1, 6); left > 0; --left) {
    network.demands.push_back(static_cast<double>(test::pick(random, 1, 20)));
  }
  return network;
}

/// Throughput by the convolution of Buzen (CACM 16(9), 1973), the delay as a station without a queue.
double throughput_by_convolution(const ClosedNetwork& network) {
  const auto n = static_cast<std::size_t>(network.customers);
  std::vector<long double> g(n + 1);
  g[0] = 1.0L;
  for (std::size_t i = 1; i <= n; ++i) {
    g[i] = g[i - 1] * static_cast<long double>(network.think) / static_cast<long double>(i);
  }
  for (const double demand : network.demands) {
    for (std::size_t i = 1; i <= n; ++i) {
      g[i] += static_cast<long double>(demand) * g[i - 1];
    }
  }
  return static_cast<double>(g[n - 1] / g[n]);
}

RC_GTEST_PROP(ClosedNetworks, MeanValuesEqualConvolutionAndKeepTheBounds, (std::uint64_t seed)) {
  test::Random random(seed);
  const ClosedNetwork network = random_network(random);
  const MeanValues values = mean_values(network);
  RC_ASSERT(values.exact);
  const double x = values.throughput;
  RC_ASSERT(std::abs(x / throughput_by_convolution(network) - 1.0) < 1e-12);
  double there = x * network.think;
  for (const double queue : values.queues) {
    there += queue;
  }
  RC_ASSERT(std::abs(there / static_cast<double>(network.customers) - 1.0) < 1e-12);
  const ThroughputRange wide = asymptotic_bounds(network);
  const ThroughputRange narrow = balanced_job_bounds(network);
  constexpr double eps = 1e-12;
  RC_ASSERT(wide.low <= narrow.low * (1 + eps));
  RC_ASSERT(narrow.low <= x * (1 + eps));
  RC_ASSERT(x <= narrow.high * (1 + eps));
  RC_ASSERT(narrow.high <= wide.high * (1 + eps));
  // With nothing exact allowed, Schweitzer's approximation stays within a tenth.
  const MeanValues rough = mean_values(network, 0);
  RC_ASSERT(!rough.exact);
  RC_ASSERT(std::abs(rough.throughput / x - 1.0) < 0.1);
}

TEST(ClosedNetworks, OfOneQueueOrNoneAreSaturatedWhereTheyMustBe) {
  EXPECT_EQ(ClosedNetwork({5, 90.0, {10.0}}).saturation(), 10.0);
  EXPECT_EQ(ClosedNetwork({5, 90.0, {}}).saturation(), std::nullopt);
  EXPECT_EQ(mean_values({5, 10.0, {}}).throughput, 0.5);
  EXPECT_EQ(mean_values({5, 10.0, {0.0}}).throughput, 0.5);
}

RC_GTEST_PROP(Bounds, HoldForEveryMachine, (std::uint64_t seed)) {
  test::Random random(seed);
  const WorkLog log = test::random_log(random, 8, 8);
  const MachineConfig machine = test::random_machine(random);
  MachineResult result = replay::replay(log, machine);
  const FrameBounds bounds = frame_bounds(machine, result);
  RC_ASSERT(bounds.least() <= result.end);
  RC_ASSERT(bounds.mean_work <= bounds.node_work);
  const std::optional<Prediction> prediction = predict(machine, result);
  RC_ASSERT(prediction.has_value() == (result.clusters[0].interconnect.reads > 0 && result.end > 0) ||
            machine.clusters > 1 || result.end == 0 || machine.placement == Placement::distributed);
  RC_ASSERT(!prediction || machine.placement != Placement::distributed);
  if (prediction) {
    RC_ASSERT(prediction->asymptotic_low <= static_cast<double>(result.end) * (1.0 + 1e-12));
    RC_ASSERT(prediction->balanced_low <= prediction->mean_value * (1.0 + 1e-9));
    RC_ASSERT(prediction->mean_value <= prediction->balanced_high * (1.0 + 1e-9));
  }
  if (bounds.least() > 0) {
    result.end = bounds.least() - 1;
    RC_ASSERT_THROWS_AS(check_bounds(machine, result), sim::InternalError);
  }
}

}  // namespace
}  // namespace marti::processors
