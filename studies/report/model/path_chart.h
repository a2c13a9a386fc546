// The critical path of a run as a chart.
#pragma once

#include "studies/report/model/report_data.h"
#include "studies/tables/run_json.h"

namespace marti::studies::report {

/// Adds a bar of the path by what is done on it, if the result has machine.critical_path.
void add_path_chart(const tables::RunJson& run, ReportData& report);

}  // namespace marti::studies::report
