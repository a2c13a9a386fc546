// The report of a directory of results.
#pragma once

#include <filesystem>
#include <optional>

#include "studies/report/model/report_data.h"
#include "studies/tables/result_directory.h"
#include "studies/tables/run_json.h"

namespace marti::studies::report {

/// Reads the directory that `marti run -o`, `marti sweep -o` or `marti study ... -o` has written, or point N
/// of a sweep ("DIR:N"). The same files give the same data. Throws UserError, naming the file and what to do,
/// for any other directory, and for what cannot be read, is damaged, of another version or too large for a
/// page. `budget`: the price that a machine of a sweep may have; UserError for a run and a study, which have
/// no machines to choose from.
[[nodiscard]] ReportData read_report(const std::filesystem::path& directory,
                                     std::optional<double> budget = std::nullopt);

// The readers of each kind of directory. They throw as read_report() does.

/// A directory of `marti run -o`: result.json, and if they exist image.png, heat-*.png and
/// working_set.vl.json beside it.
[[nodiscard]] ReportData read_run_report(const std::filesystem::path& directory);

/// What the result of a run says, without the files beside it. Throws UserError when a field is missing.
[[nodiscard]] ReportData report_of_run(const tables::RunJson& run);

/// A point of a sweep.
[[nodiscard]] ReportData read_point_report(const tables::PointName& point);

/// A directory of `marti study ... -o`: results.sqlite, and if they exist *.png and report.txt beside it.
[[nodiscard]] ReportData read_study_report(const std::filesystem::path& directory);

}  // namespace marti::studies::report
