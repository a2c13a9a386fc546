// One reader for each kind of directory that a report is made of. All throw UserError, naming the file and
// what to do.
#pragma once

#include <filesystem>

#include "studies/report/report_charts.h"

namespace marti::studies {

/// A directory of `marti run -o`: result.json, and if they exist image.png, heat-*.png, working_set.vl.json
/// and attribution.csv beside it.
[[nodiscard]] ReportData read_run_report(const std::filesystem::path& directory);

/// A directory of `marti sweep -o`: results.sqlite.
[[nodiscard]] ReportData read_sweep_report(const std::filesystem::path& directory);

/// A directory of `marti study ... -o`: results.sqlite, and if they exist *.vl.json, *.png and report.txt
/// beside it.
[[nodiscard]] ReportData read_study_report(const std::filesystem::path& directory);

}  // namespace marti::studies
