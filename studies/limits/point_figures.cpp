#include "studies/limits/point_figures.h"

#include <algorithm>
#include <initializer_list>
#include <string>

namespace marti::studies {

namespace {

using processors::Activity;

// Sets the figures that are sums of activities; `time` gives the time of one.
template <class Time>
void set_times(PointFigures& figures, const Time& time) {
  const auto sum = [&](std::initializer_list<Activity> activities) {
    double all = 0.0;
    for (const Activity activity : activities) {
      all += time(static_cast<std::size_t>(activity));
    }
    return all;
  };
  figures.computing = sum({Activity::traversal, Activity::intersection, Activity::shading, Activity::building,
                           Activity::switching, Activity::messaging});
  figures.cache_access = sum({Activity::cache_access});
  figures.transfer = sum({Activity::transfer});
  figures.bank_access = sum({Activity::bank_access});
  figures.delays = sum({Activity::dispatch_wait, Activity::message_wait, Activity::lock_wait});
  figures.queue_full_wait = sum({Activity::queue_full_wait});
  figures.idle = sum({Activity::idle});
}

}  // namespace

PointFigures figures_of(const processors::MachineResult& result) {
  PointFigures figures;
  const processors::TimeDivision time = result.time();
  set_times(figures, [&](std::size_t activity) { return static_cast<double>(time[activity]); });
  figures.end = static_cast<double>(result.end);
  figures.packets = static_cast<double>(result.packets);
  figures.database_bytes = static_cast<double>(result.database_bytes);
  figures.host_requests = static_cast<double>(result.host.requests);
  const processors::ReferenceCounts references = result.references();
  figures.references = static_cast<double>(references.references());
  figures.misses = static_cast<double>(references.all_misses());
  if (!result.nodes.empty()) {
    figures.earliest_finish = figures.end;
  }
  for (const processors::NodeStatistics& node : result.nodes) {
    figures.pixels += static_cast<double>(node.writes);
    figures.earliest_finish = std::min(figures.earliest_finish, static_cast<double>(node.finish));
  }
  for (const processors::ClusterResult& cluster : result.clusters) {
    figures.reads += static_cast<double>(cluster.interconnect.reads);
    figures.writes += static_cast<double>(cluster.interconnect.writes);
    figures.interconnect_busy += static_cast<double>(cluster.interconnect.busy);
    figures.links += static_cast<double>(cluster.interconnect.links);
    for (const memory::BankStatistics& bank : cluster.banks) {
      const auto busy = static_cast<double>(bank.busy);
      figures.bank_busy += busy;
      figures.most_bank_busy = std::max(figures.most_bank_busy, busy);
      figures.bank_waits += static_cast<double>(bank.waits.sum);
    }
  }
  return figures;
}

PointFigures figures_of_columns(const std::function<double(std::string_view)>& column) {
  PointFigures figures;
  set_times(figures, [&](std::size_t activity) {
    return column("time_" + std::string(processors::activity_names[activity]));
  });
  figures.end = column("end");
  figures.packets = column("packets");
  figures.pixels = column("node_writes");
  figures.database_bytes = column("database_bytes");
  figures.earliest_finish = column("earliest_finish");
  figures.host_requests = column("host_requests");
  figures.references = column("hits") + column("misses");
  figures.misses = column("misses");
  figures.reads = column("interconnect_reads");
  figures.writes = column("interconnect_writes");
  figures.interconnect_busy = column("interconnect_busy");
  figures.links = column("interconnect_links");
  figures.bank_busy = column("bank_busy");
  figures.most_bank_busy = column("most_bank_busy");
  figures.bank_waits = column("bank_wait_sum");
  return figures;
}

}  // namespace marti::studies
