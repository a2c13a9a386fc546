#include "studies/sweep/store/sweep_metrics.h"

#include <string>
#include <vector>

#include "sim/error.h"
#include "sim/nearest.h"

namespace marti::studies {

std::span<const SweepMetric> derived_metrics() {
  static const std::vector<SweepMetric> metrics = {
      {"speed_up", "1", "frame time of the base machine / frame time", Better::higher},
      {"efficiency", "fraction", "speed_up / (nodes / nodes of the base machine)", Better::higher},
      {"times_faster", "1", "frame time of the machine of [sweep.compare] / frame time", Better::higher},
      {"hit_ratio", "fraction", "lines found in the nodes' own caches / lines looked up", Better::higher},
      {"interconnect_utilisation", "fraction",
       "share of the frame time that the busiest cluster's links transfer", Better::lower},
  };
  return metrics;
}

SweepMetric find_metric(std::string_view name, std::span<const Column> columns) {
  std::vector<std::string> names;
  for (const SweepMetric& metric : derived_metrics()) {
    if (metric.name == name) {
      return metric;
    }
    names.push_back(metric.name);
  }
  for (const Column& column : columns) {
    if (column.name == name) {
      const bool higher = name == "hits" || name.ends_with("_hits");
      return {column.name, column.unit, column.description, higher ? Better::higher : Better::lower};
    }
    names.push_back(column.name);
  }
  throw sim::UserError(
      "\"" + std::string(name) + "\" is no metric" + sim::did_you_mean(name, names) +
      "; there are speed_up, efficiency, times_faster, hit_ratio, interconnect_utilisation and "
      "the counters of a sweep, as \"end\", the frame time");
}

}  // namespace marti::studies
