// What a plan asks for, entered into the store.
#pragma once

#include <cstdint>
#include <vector>

#include "studies/sweep/plan/sweep_plan.h"
#include "studies/tables/sqlite_connection.h"

namespace marti::studies::sweep {

/// The ids under which the store knows what is in a plan.
struct StoreIds {
  std::vector<std::int64_t> frames;    ///< of each of SweepPlan::frames
  std::vector<std::int64_t> machines;  ///< of each of SweepPlan::machines
};

/// Enters what the store does not know yet, in the plan's order, so that the same plans in the same order
/// give the same ids; what other plans asked for stays. The tables of the present plan (points, compare,
/// provenance, columns) are made anew. Within a transaction.
[[nodiscard]] StoreIds enter_plan(tables::SqliteConnection& connection, const SweepPlan& plan);

}  // namespace marti::studies::sweep
