// The charts of a run: where the time goes, references and hit ratios, levels and memory, waits, nodes.
#pragma once

#include "studies/report/report_charts.h"
#include "studies/report/run_json.h"

namespace marti::studies {

/// Adds those whose data the result has.
void add_run_charts(const RunJson& run, ReportData& report);

}  // namespace marti::studies
