// The charts of a run: where the time goes, references and hit ratios, levels and memory, waits, nodes, the
// critical path.
#pragma once

#include <cstdint>
#include <string_view>

#include "studies/report/model/report_data.h"
#include "studies/tables/run_json.h"

namespace marti::studies::report {

/// The field if it is a whole number from 0 on that fits; else 0.
[[nodiscard]] std::int64_t whole(const tables::RunJson& part, std::string_view path);

/// Adds the charts for which the result has data. UserError, naming the file, when its counts are too large.
void add_run_charts(const tables::RunJson& run, ReportData& report);

}  // namespace marti::studies::report
