// What would make the frame of a run shorter, as a table.
#pragma once

#include "studies/tables/run_json.h"
#include "studies/tables/table.h"

namespace marti::studies::report {

/// All steps of the result's field machine.what_helps; without rows where it is missing.
[[nodiscard]] tables::Table helps_table(const tables::RunJson& run);

}  // namespace marti::studies::report
