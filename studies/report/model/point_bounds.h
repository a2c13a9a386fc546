// Bounds of a point's frame that follow from its counters: how short it can be at best, and from how many
// nodes on its busiest queue is full. docs/internals/pages.md has the equations.
#pragma once

#include <optional>

#include "studies/report/model/report_points.h"

namespace marti::studies::report {

/// The largest of the work shared by all nodes, the busiest link and the busiest bank, in ps: no frame with
/// these counters is shorter. All links count as equally busy, and all banks.
[[nodiscard]] double bound_of(const ReportPoint& point);

/// The number of nodes of a cluster from which on the busiest queue limits; std::nullopt for a
/// machine without queues.
[[nodiscard]] std::optional<double> saturation_of(const ReportPoint& point);

}  // namespace marti::studies::report
