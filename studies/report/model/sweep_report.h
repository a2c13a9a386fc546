// The report of a sweep.
#pragma once

#include "studies/report/model/report_data.h"
#include "studies/report/model/report_points.h"

namespace marti::studies {

[[nodiscard]] ReportData sweep_report(const ReportPoints& sweep);

}  // namespace marti::studies
