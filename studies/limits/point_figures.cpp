#include "studies/limits/point_figures.h"

#include <initializer_list>
#include <string_view>

namespace marti::studies::limits {

PointFigures point_figures(const figures::Counts& counts) {
  const auto sum = [&](std::initializer_list<std::string_view> figures) {
    double all = 0.0;
    for (const std::string_view figure : figures) {
      all += static_cast<double>(figures::count_of(counts, figure).value_or(0));
    }
    return all;
  };
  PointFigures figures;
  figures.computing = sum({"time_traversal", "time_intersection", "time_shading", "time_building",
                           "time_switching", "time_messaging"});
  figures.cache_access = sum({"time_cache_access"});
  figures.transfer = sum({"time_transfer"});
  figures.bank_access = sum({"time_bank_access"});
  figures.delays = sum({"time_dispatch_wait", "time_message_wait", "time_lock_wait"});
  figures.queue_full_wait = sum({"time_queue_full_wait"});
  figures.idle = sum({"time_idle"});
  figures.end = sum({"end"});
  figures.packets = sum({"packets"});
  figures.pixels = sum({"node_writes"});
  figures.database_bytes = sum({"database_bytes"});
  figures.earliest_finish = sum({"earliest_finish"});
  figures.host_requests = sum({"host_requests"});
  figures.references = sum({"hits", "misses"});
  figures.misses = sum({"misses"});
  figures.reads = sum({"interconnect_reads"});
  figures.writes = sum({"interconnect_writes"});
  figures.interconnect_busy = sum({"interconnect_busy"});
  figures.links = sum({"interconnect_links"});
  figures.bank_busy = sum({"bank_busy"});
  figures.most_bank_busy = sum({"most_bank_busy"});
  figures.bank_waits = sum({"bank_wait_sum"});
  return figures;
}

}  // namespace marti::studies::limits
