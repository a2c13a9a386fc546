#include "studies/report/model/point_bounds.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>

#include "processors/cost/accounting.h"

namespace marti::studies::report {

namespace {

using processors::cost::ActivityKind;

double time_of(const ReportPoint& point, std::initializer_list<ActivityKind> kinds) {
  return processors::cost::sum_of_kinds(kinds, [&](std::size_t i) {
    return point.figure("time_" + std::string(processors::cost::activity_names[i]));
  });
}

// Time of all nodes without waits and idling.
double work_of(const ReportPoint& point) {
  return time_of(point, {ActivityKind::computing, ActivityKind::memory});
}

double clusters_of(const ReportPoint& point) { return std::max(1.0, point.figure("clusters")); }

// Busy time of one of a cluster's queues of a kind, of which all clusters have `count`; 0 where these are no
// queues.
double busy_of_one(const ReportPoint& point, bool are_queues, const char* count, const char* busy) {
  const double in_a_cluster = std::round(point.figure(count) / clusters_of(point));
  return are_queues && in_a_cluster > 0.0 ? point.figure(busy) / clusters_of(point) / in_a_cluster : 0.0;
}

double busiest_of(const ReportPoint& point) {
  return std::max(busy_of_one(point, point.links_are_queues, "interconnect_links", "interconnect_busy"),
                  busy_of_one(point, point.banks_are_queues, "banks", "bank_busy"));
}

}  // namespace

double bound_of(const ReportPoint& point) {
  const double packets = point.figure("packets");
  const double nodes = std::max(1.0, point.figure("nodes"));
  const double at_work = packets > 0.0 ? std::min(nodes, packets) : nodes;
  const double in_a_cluster = std::max(1.0, std::ceil(at_work / clusters_of(point)));
  return std::max(work_of(point) / clusters_of(point) / in_a_cluster, busiest_of(point));
}

std::optional<double> saturation_of(const ReportPoint& point) {
  const double busiest = busiest_of(point);
  if (busiest <= 0.0) {
    return std::nullopt;
  }
  const double queues = (point.links_are_queues ? point.figure("interconnect_busy") : 0.0) +
                        (point.banks_are_queues ? point.figure("bank_busy") : 0.0);
  const double round = work_of(point) + time_of(point, {ActivityKind::delay});
  return std::max(round, queues) / clusters_of(point) / busiest;
}

}  // namespace marti::studies::report
