// The analytic model of reports, where the right answer is known.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "processors/theory/closed_network.h"
#include "studies/report/model/line_model.h"
#include "studies/report/model/sweep_model.h"

namespace marti::studies {

using namespace report;

namespace {

// A bus machine of `nodes` nodes with 1000 reads: 100 ps of computing and 10 ps of the bus each.
PointCounters bus_machine(double nodes, double end) {
  PointCounters counters;
  counters.x = nodes;
  counters.nodes = nodes;
  counters.packets = 1e6;
  counters.reads = 1000.0;
  counters.link_busy = 10'000.0;
  counters.work = 110'000.0;
  counters.end = end;
  counters.base_end = 110'000.0;
  return counters;
}

TEST(ClosedNetworkEnd, OneNodeMeetsNobody) {
  EXPECT_DOUBLE_EQ(closed_network_end(bus_machine(1, 1)), 110'000.0);
}

// One queue with exponential times is the machine repairman, whose utilisation is known by Erlang's formula.
TEST(ClosedNetworkEnd, IsTheMachineRepairman) {
  for (const unsigned nodes : {2U, 5U, 11U, 40U}) {
    const double busy = processors::theory::repairman_utilisation(nodes, 100.0, 10.0);
    EXPECT_NEAR(closed_network_end(bus_machine(nodes, 1)), 10'000.0 / busy, 1e-6 * 10'000.0) << nodes;
  }
}

TEST(ClosedNetworkEnd, LiesBetweenItsAsymptotes) {
  for (double nodes = 1; nodes <= 512; nodes *= 2) {
    const PointCounters counters = bus_machine(nodes, 1);
    EXPECT_GE(closed_network_end(counters), asymptotic_end(counters) * (1 - 1e-12));
    EXPECT_DOUBLE_EQ(asymptotic_end(counters), std::max(110'000.0 / nodes, 10'000.0));
  }
  EXPECT_NEAR(closed_network_end(bus_machine(4096, 1)), 10'000.0, 1.0) << "the bus is never free";
  EXPECT_DOUBLE_EQ(saturation_nodes(bus_machine(16, 1)).value(), 11.0);
}

TEST(ClosedNetworkEnd, WithoutReadsNobodyWaits) {
  PointCounters counters = bus_machine(8, 1);
  counters.reads = 0.0;
  EXPECT_DOUBLE_EQ(closed_network_end(counters), 110'000.0 / 8);
  EXPECT_FALSE(saturation_nodes(counters).has_value());
}

TEST(ClosedNetworkEnd, NoMoreNodesWorkThanThereArePackets) {
  PointCounters counters = bus_machine(64, 1);
  counters.packets = 4;
  EXPECT_DOUBLE_EQ(closed_network_end(counters), closed_network_end(bus_machine(4, 1)));
}

TEST(AsymptoticEnd, IsABoundWhereNodesDoNotShareEvenly) {
  PointCounters counters = bus_machine(5, 1);
  counters.reads = 0.0;
  counters.clusters = 2;  // of 3 and 2 nodes
  counters.links = 2;
  EXPECT_DOUBLE_EQ(asymptotic_end(counters), 110'000.0 / 2 / 3);
  counters.packets = 4.4;  // interpolated
  EXPECT_DOUBLE_EQ(asymptotic_end(counters), 110'000.0 / 2 / 3);
  counters.packets = 4.0 * (1.0 + 1e-15);
  EXPECT_DOUBLE_EQ(asymptotic_end(counters), 110'000.0 / 2 / 2);
}

TEST(ClosedNetworkEnd, HasNoMoreQueuesThanAConfiguration) {
  PointCounters counters = bus_machine(4, 1);
  counters.banks = 65536;
  counters.bank_busy = 10'000.0;
  const double end = closed_network_end(counters);
  for (const double banks : {2e9, 1e300}) {
    counters.banks = banks;
    EXPECT_DOUBLE_EQ(closed_network_end(counters), end) << banks;
  }
  counters.banks = -1e300;
  EXPECT_DOUBLE_EQ(closed_network_end(counters), closed_network_end(bus_machine(4, 1)));
}

TEST(ClosedNetworkEnd, ClustersShareTheWork) {
  PointCounters counters = bus_machine(8, 1);
  counters.clusters = 2;
  counters.links = 2;
  PointCounters half = bus_machine(4, 1);
  half.reads /= 2;
  half.link_busy /= 2;
  half.work /= 2;
  EXPECT_NEAR(closed_network_end(counters), closed_network_end(half), 1e-6);
}

TEST(LineModel, IsExactAtItsPoints) {
  const LineModel line({bus_machine(1, 120'000), bus_machine(16, 15'000), bus_machine(4, 33'000)}, true);
  EXPECT_DOUBLE_EQ(line.at(1).end, 120'000);
  EXPECT_NEAR(line.at(4).end, 33'000, 1e-6);
  EXPECT_NEAR(line.at(16).end, 15'000, 1e-6);
  EXPECT_EQ(line.at(4).zone, Zone::between);
  EXPECT_EQ(line.at(16.1).zone, Zone::beyond);
  EXPECT_EQ(line.at(0.9).zone, Zone::beyond);
}

// For machines that are closed networks the model is right between their points too, since only nodes change.
TEST(LineModel, FindsAMachineThatIsANetwork) {
  std::vector<PointCounters> points;
  for (const double nodes : {1.0, 4.0, 16.0, 64.0}) {
    points.push_back(bus_machine(nodes, closed_network_end(bus_machine(nodes, 1))));
  }
  const LineModel line(points, true);
  for (const double nodes : {2.0, 8.0, 11.0, 32.0, 128.0}) {
    const double exact = closed_network_end(bus_machine(nodes, 1));
    EXPECT_NEAR(line.at(nodes).end, exact, 1e-6 * exact) << nodes;
  }
  LeaveOneOut errors;
  errors.add(line, true);
  EXPECT_EQ(errors.of_end(Zone::between).points, 2U);
  EXPECT_EQ(errors.of_end(Zone::beyond).points, 2U);
  EXPECT_NEAR(errors.of_end(Zone::between).p95, 0.0, 1e-9);
  EXPECT_NEAR(errors.of_end(Zone::beyond).p95, 0.0, 1e-9);
}

TEST(LineModel, IsNeverBelowItsBound) {
  const LineModel line({bus_machine(4, 30'000), bus_machine(16, 10'000)}, true);
  for (double nodes = 1; nodes < 100; nodes *= 1.3) {
    const Modelled modelled = line.at(nodes);
    EXPECT_GE(modelled.end, modelled.asymptote);
  }
}

TEST(LeaveOneOut, MeasuresTheErrorOfAPointThatIsElsewhere) {
  std::vector<PointCounters> points;
  for (const double nodes : {1.0, 2.0, 4.0}) {
    points.push_back(bus_machine(nodes, closed_network_end(bus_machine(nodes, 1))));
  }
  points[1].end *= 1.25;
  LeaveOneOut errors;
  errors.add(LineModel(points, true), true);
  EXPECT_EQ(errors.of_end(Zone::between).points, 1U);
  EXPECT_NEAR(errors.of_end(Zone::between).mean, 0.25, 1e-9);
  EXPECT_NEAR(errors.of_end(Zone::between).p95, 0.25, 1e-9);
  EXPECT_EQ(errors.of_speed_up(Zone::between).points, 1U);
}

TEST(LeaveOneOut, PassesOverPointsFarBeyondTheOthers) {
  LeaveOneOut errors;
  errors.add(LineModel({bus_machine(1, 110'000), bus_machine(2, 60'000), bus_machine(64, 11'000)}, true),
             true);
  EXPECT_EQ(errors.of_end(Zone::between).points, 1U);
  EXPECT_EQ(errors.of_end(Zone::beyond).points, 1U) << "64 is five steps beyond 2";
}

TEST(ModelError, IsKnownWhenItIsMeasuredAndSmallEnough) {
  EXPECT_FALSE((ModelError{0, 0.0, 0.0}).is_known());
  EXPECT_TRUE((ModelError{1, 0.1, 2.0}).is_known());
  EXPECT_FALSE((ModelError{1, 0.1, 2.1}).is_known());
}

TEST(LeaveOneOut, NeedsThreePointsOnALine) {
  LeaveOneOut errors;
  errors.add(LineModel({bus_machine(1, 110'000), bus_machine(2, 60'000)}, true), true);
  EXPECT_EQ(errors.of_end(Zone::between).points + errors.of_end(Zone::beyond).points, 0U);
}

ReportPoints sweep_over_nodes(const std::vector<double>& nodes) {
  ReportPoints sweep;
  ReportAxis axis;
  axis.name = "machine.nodes";
  axis.numeric = true;
  axis.logarithmic = true;
  axis.integer = true;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    axis.values.emplace_back(static_cast<std::int64_t>(nodes[i]));
    axis.texts.push_back(std::to_string(static_cast<int>(nodes[i])));
    ReportPoint point;
    point.place = {i};
    point.links_are_queues = true;
    const double end = closed_network_end(bus_machine(nodes[i], 1));
    point.figures = {{"end", end},
                     {"nodes", nodes[i]},
                     {"clusters", 1.0},
                     {"packets", 1e6},
                     {"speed_up", 110'000.0 / end},
                     {"time_traversal", 110'000.0},
                     {"interconnect_reads", 1000.0},
                     {"interconnect_links", 1.0},
                     {"interconnect_busy", 10'000.0}};
    sweep.points.push_back(std::move(point));
  }
  sweep.axes.push_back(std::move(axis));
  return sweep;
}

TEST(ModelSweep, ReachesOneStepBeyondThePoints) {
  const std::vector<AxisModel> models = model_sweep(sweep_over_nodes({4, 16, 64}));
  ASSERT_EQ(models.size(), 1U);
  const AxisModel& model = models.front();
  EXPECT_EQ(model.x.front(), 1.0);
  EXPECT_EQ(model.x.back(), 256.0);
  EXPECT_TRUE(std::is_sorted(model.x.begin(), model.x.end()));
  ASSERT_TRUE(model.curves.contains("*"));
  for (std::size_t i = 0; i < model.x.size(); ++i) {
    const std::optional<Modelled>& sample = model.curves.at("*").samples[i];
    ASSERT_TRUE(sample.has_value());
    const double exact = closed_network_end(bus_machine(model.x[i], 1));
    EXPECT_NEAR(sample->end, exact, 1e-4 * exact) << model.x[i];
  }
  EXPECT_NEAR(model.curves.at("*").saturation.value(), 11.0, 1e-9);
}

TEST(ModelSweep, KeepsToTheRangeOfTheKey) {
  ReportPoints sweep = sweep_over_nodes({2, 256, 65536});
  sweep.axes.front().name = "memory.banks";
  const std::vector<AxisModel> models = model_sweep(sweep);
  ASSERT_EQ(models.size(), 1U);
  EXPECT_EQ(models.front().x.front(), 1.0);
  EXPECT_EQ(models.front().x.back(), 65536.0);
}

TEST(ModelSweep, GoesNowhereWithoutABand) {
  // Either end is many steps of its neighbours away, so that only the error between points is measured.
  const std::vector<AxisModel> models = model_sweep(sweep_over_nodes({1, 30, 31, 900}));
  ASSERT_EQ(models.size(), 1U);
  const AxisModel& model = models.front();
  ASSERT_TRUE(model.has_band(Zone::between));
  ASSERT_FALSE(model.has_band(Zone::beyond));
  for (std::size_t i = 0; i < model.x.size(); ++i) {
    EXPECT_EQ(model.curves.at("*").samples[i].has_value(), model.x[i] >= 1.0 && model.x[i] <= 900.0)
        << model.x[i];
  }
}

TEST(ModelSweep, SaysNothingWithoutAMeasuredError) {
  EXPECT_TRUE(model_sweep(sweep_over_nodes({4, 16})).empty());
}

TEST(ModelSweep, KeepsToItsLimit) { EXPECT_TRUE(model_sweep(sweep_over_nodes({4, 16, 64}), 3).empty()); }

}  // namespace
}  // namespace marti::studies
