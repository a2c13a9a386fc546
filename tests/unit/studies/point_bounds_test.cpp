// Bounds of a point's frame, where the right answer is known.
#include "studies/report/model/point_bounds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace marti::studies {

using namespace report;

namespace {

// A bus machine with 1000 reads: 100 ps of computing and 10 ps of the bus each.
ReportPoint bus_machine(double nodes) {
  ReportPoint point;
  point.links_are_queues = true;
  point.figures = {{"nodes", nodes},
                   {"packets", 1e6},
                   {"interconnect_links", 1.0},
                   {"interconnect_busy", 10'000.0},
                   {"time_traversal", 100'000.0},
                   {"time_transfer", 10'000.0}};
  return point;
}

TEST(BoundOf, IsTheWorkOfEachNodeOrTheBusiestQueue) {
  EXPECT_DOUBLE_EQ(bound_of(bus_machine(1)), 110'000.0);
  EXPECT_DOUBLE_EQ(bound_of(bus_machine(5)), 22'000.0);
  EXPECT_DOUBLE_EQ(bound_of(bus_machine(64)), 10'000.0) << "the bus";
  ReportPoint banks = bus_machine(64);
  banks.figures["banks"] = 4;
  banks.figures["bank_busy"] = 60'000.0;
  EXPECT_DOUBLE_EQ(bound_of(banks), 10'000.0) << "its banks are no queues";
  banks.banks_are_queues = true;
  EXPECT_DOUBLE_EQ(bound_of(banks), 15'000.0);
}

TEST(BoundOf, HoldsWhereNodesDoNotShareEvenly) {
  ReportPoint point = bus_machine(5);
  point.figures["clusters"] = 2;  // of 3 and 2 nodes
  point.figures["interconnect_links"] = 2;
  EXPECT_DOUBLE_EQ(bound_of(point), 110'000.0 / 2 / 3);
  point.figures["packets"] = 4;
  EXPECT_DOUBLE_EQ(bound_of(point), 110'000.0 / 2 / 2) << "no more nodes have work than there are packets";
}

TEST(SaturationOf, IsTheRoundByTheBusiestQueue) {
  EXPECT_DOUBLE_EQ(saturation_of(bus_machine(4)).value(), 11.0);
  ReportPoint waiting = bus_machine(4);
  waiting.figures["time_dispatch_wait"] = 10'000.0;
  EXPECT_DOUBLE_EQ(saturation_of(waiting).value(), 12.0);
  ReportPoint clusters = bus_machine(8);
  clusters.figures["clusters"] = 2;
  clusters.figures["interconnect_links"] = 2;
  EXPECT_DOUBLE_EQ(saturation_of(clusters).value(), 11.0) << "each cluster has a bus and half of the work";
  ReportPoint ideal = bus_machine(4);
  ideal.links_are_queues = false;
  EXPECT_EQ(saturation_of(ideal), std::nullopt);
}

}  // namespace
}  // namespace marti::studies
