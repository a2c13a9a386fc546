// The figures by which machines of a sweep are compared.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "studies/sweep/store/sweep_best.h"
#include "studies/tables/table.h"

namespace marti::studies {

struct SweepMetric {
  std::string name;
  std::string unit;
  std::string description;
  Better better = Better::lower;
};

/// The metrics that are formulas of counters: speed_up, efficiency, times_faster, hit_ratio,
/// interconnect_utilisation. The store's view `summary` has the formulas (sweep/store/store_columns.h).
[[nodiscard]] std::span<const SweepMetric> derived_metrics();

/// The metric of that name: a derived one, or one of `columns`, for which less is better (except "hits").
/// Throws UserError for another name, with the nearest valid one.
[[nodiscard]] SweepMetric find_metric(std::string_view name, std::span<const Column> columns);

}  // namespace marti::studies
